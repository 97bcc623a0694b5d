// Numbers and lists of numbers written as bytes, and read back from bytes that may be damaged. [any thread]
//
//   ByteWriter out;  out.put(3.5).put_list(std::span(numbers));
//   ByteReader in(bytes);  if (!in.get(x) || !in.get_list(list, 1000) || !in.finished()) ...damaged...
//
// The bytes have this machine's byte order, so they suit files that stay on one machine, such as those of a cache.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace ringdown {

class ByteWriter {
 public:
  template <class T>
  requires std::is_trivially_copyable_v<T> ByteWriter& put(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  template <class T>
  requires std::is_trivially_copyable_v<T> ByteWriter& put_list(std::span<const T> list) {
    put(static_cast<std::uint64_t>(list.size()));
    bytes_.append(reinterpret_cast<const char*>(list.data()), list.size_bytes());
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  // Returns false and reads nothing if the bytes end too soon.
  template <class T>
  requires std::is_trivially_copyable_v<T>
  bool get(T& value) {
    if (rest_.size() < sizeof value) return false;
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_.remove_prefix(sizeof value);
    return true;
  }
  // Returns false if the bytes end too soon or the list claims to be longer than the remaining bytes; the length is
  // checked before memory is allocated.
  template <class T>
  requires std::is_trivially_copyable_v<T>
  bool get_list(std::vector<T>& list) {
    std::uint64_t count = 0;
    if (!get(count) || count > rest_.size() / sizeof(T)) return false;
    list.resize(count);
    if (count > 0) std::memcpy(list.data(), rest_.data(), count * sizeof(T));
    rest_.remove_prefix(count * sizeof(T));
    return true;
  }
  [[nodiscard]] bool finished() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

}  // namespace ringdown
