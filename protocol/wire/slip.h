// SLIP (RFC 1055), which OSC 1.1 frames packets with in a stream: END at both ends, END and ESC escaped inside.
// [any thread]
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace ringdown::wire {

std::vector<std::byte> slip_encode(std::span<const std::byte> packet);

class SlipDecoder {
 public:
  // Packets longer than `limit` are an error, found before they are kept.
  explicit SlipDecoder(std::size_t limit) : limit_(limit) {}

  enum class Outcome { more, packet, fault };
  // One byte of the stream. After `packet`, take() has it; after `fault` (too long, or a wrong escape) the stream
  // cannot be trusted any more.
  Outcome push(std::byte byte);
  std::vector<std::byte> take();

 private:
  std::size_t limit_;
  bool escaped_ = false;
  std::vector<std::byte> packet_;
};

}  // namespace ringdown::wire
