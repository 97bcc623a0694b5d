// Whether a datagram is OSC 1.0 that we accept, checked byte by byte before any library reads it.
//
// liblo 0.31 reads past the end of malformed packets; it only ever sees messages that passed here. [any thread]
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ringdown::wire {

// NTP time: seconds since 1900 in the upper 32 bits, fractions of a second in the lower. 1 means immediately.
using TimeTag = std::uint64_t;
inline constexpr TimeTag kImmediately = 1;
inline constexpr double kTicksPerSecond = 4294967296;

inline constexpr std::size_t kMaxPacketBytes = 65536;  // bytes; more than UDP can carry
inline constexpr std::size_t kMaxAddress = 256;
inline constexpr std::size_t kMaxArguments = 64;
inline constexpr int kMaxBundle = 4;

// One message inside a packet, with the time of the bundle around it.
struct RawMessage {
  TimeTag time = kImmediately;
  std::span<const std::byte> bytes;  // into the packet
};

// The messages of a packet in their order, bundles opened. A message without a bundle has time kImmediately; in a
// bundle inside a bundle it has the later of the two times, as OSC 1.0 asks of senders. A packet with any fault is
// refused whole; the sentence names the address, if it got that far, and what is wrong. Checked: the length, a multiple
// of 4; that every string ends inside the packet and is padded with zeros; addresses of printable characters; argument
// types i h f d s b only; the limits above; that nothing is left over.
Result<std::vector<RawMessage>> split_packet(std::span<const std::byte> packet);

}  // namespace ringdown::wire
