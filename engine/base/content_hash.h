// A 128-bit hash of content: different content has a different hash, almost certainly. [any thread]
//
//   const ContentHash hash = ContentHasher().text(file).value(1e-9).values(std::span(numbers)).hash();
//
// The hash is XXH3-128 (libxxhash), computed at memory speed. Among n contents the chance that any two share a hash is
// about n^2 / 2^129. XXH3 does not protect against deliberate collisions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace ringdown {

struct ContentHash {
  std::uint64_t high = 0, low = 0;
  [[nodiscard]] std::string text() const;  // 32 hexadecimal digits
  friend bool operator==(const ContentHash&, const ContentHash&) = default;
};

// Hashes content piece by piece. Lengths are hashed too, so that ("ab", "c") and ("a", "bc") differ. Numbers are hashed
// as they lie in memory, so hashes differ between machines of different byte order.
class ContentHasher {
 public:
  ContentHasher();
  ~ContentHasher();
  ContentHasher(const ContentHasher&) = delete;
  ContentHasher& operator=(const ContentHasher&) = delete;

  ContentHasher& bytes(std::span<const std::byte> content);
  ContentHasher& text(std::string_view content) { return bytes(std::as_bytes(std::span(content))); }
  template <class T>
  requires std::is_arithmetic_v<T> ContentHasher& values(std::span<const T> numbers) {
    return bytes(std::as_bytes(numbers));
  }
  template <class T>
  requires std::is_arithmetic_v<T> ContentHasher& value(T number) { return values(std::span<const T>(&number, 1)); }
  [[nodiscard]] ContentHash hash() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

ContentHash hash_of(std::string_view content);

}  // namespace ringdown
