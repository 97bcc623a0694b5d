// How packets follow each other in a TCP stream. Two framings are in use, and both are spoken: SLIP (OSC 1.1), and a
// big-endian int32 with the packet's length before each packet (OSC 1.0), which liblo and SuperCollider send by
// default. [any thread]
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

// Tells the framing by the stream's first byte: packets are so short that their length begins with a zero, and SLIP
// begins with END (0xC0) or with the packet's own / or #.
class FrameDecoder {
 public:
  // `limit`: of a packet's bytes, less than 2^24. Longer packets are a fault, found before they are kept.
  explicit FrameDecoder(std::size_t limit) : limit_(limit), slip_(limit) {}

  using Outcome = SlipDecoder::Outcome;
  // One byte of the stream. After `packet`, take() has it; after `fault` the stream cannot be trusted any more. Packets
  // without bytes are left out.
  Outcome push(std::byte byte);
  std::vector<std::byte> take();

  // SLIP until the first byte has come.
  [[nodiscard]] Framing framing() const { return framing_.value_or(Framing::slip); }

 private:
  Outcome push_counted(std::byte byte);

  std::size_t limit_;
  std::optional<Framing> framing_;
  SlipDecoder slip_;
  std::size_t length_ = 0, length_bytes_ = 0;  // the length so far, and how many of its four bytes have come
  std::vector<std::byte> packet_;
};

// The packet with what goes before and after it.
std::vector<std::byte> frame(std::span<const std::byte> packet, Framing framing);

}  // namespace ringdown::wire
