// Separates packets in a TCP stream. Two framings are supported: SLIP (OSC 1.1), and a big-endian int32 with the
// packet's length before each packet (OSC 1.0), which liblo and SuperCollider send by default. [any thread]
//
//   FrameDecoder decoder(kMaxPacketBytes);
//   if (decoder.push(byte) == FrameDecoder::Outcome::packet) handle(decoder.take());
//   send(frame(answer, decoder.framing()));    // in the framing of the client
#pragma once

#include "protocol/wire/slip.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace ringdown::wire {

enum class Framing : std::uint8_t { slip, length };

// Detects the framing by the stream's first byte: packets are so short that their length begins with a zero, and SLIP
// begins with END (0xC0) or with the packet's own / or #.
class FrameDecoder {
 public:
  // `limit`: maximum number of bytes in a packet, less than 2^24. Longer packets are a fault, found before they are
  // stored.
  explicit FrameDecoder(std::size_t limit) : limit_(limit), slip_(limit) {}

  using Outcome = SlipDecoder::Outcome;
  // Takes one byte of the stream. After `packet`, take() returns the packet; after `fault` the stream is unusable.
  // Empty packets are ignored.
  Outcome push(std::byte byte);
  std::vector<std::byte> take();

  // The stream's framing; SLIP before the first byte.
  [[nodiscard]] Framing framing() const { return framing_.value_or(Framing::slip); }

 private:
  Outcome push_counted(std::byte byte);

  std::size_t limit_;
  std::optional<Framing> framing_;
  SlipDecoder slip_;
  std::size_t length_ = 0, length_bytes_ = 0;  // the length so far, and how many of its four bytes have been read
  std::vector<std::byte> packet_;
};

// Returns the packet with its framing.
std::vector<std::byte> frame(std::span<const std::byte> packet, Framing framing);

}  // namespace ringdown::wire
