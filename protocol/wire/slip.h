// SLIP (RFC 1055), the framing of packets in a stream in OSC 1.1: END at both ends, END and ESC escaped inside.
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
  // Packets longer than `limit` are a fault, found before they are stored.
  explicit SlipDecoder(std::size_t limit) : limit_(limit) {}

  enum class Outcome { more, packet, fault };
  // Takes one byte of the stream. After `packet`, take() returns the packet; after `fault` (too long, or a wrong
  // escape) the stream is unusable.
  Outcome push(std::byte byte);
  std::vector<std::byte> take();

 private:
  std::size_t limit_;
  bool escaped_ = false;
  std::vector<std::byte> packet_;
};

}  // namespace ringdown::wire
