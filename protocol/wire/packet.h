// Reads OSC packets, byte by byte. [any thread but audio]
//
// Our own instead of liblo's: liblo 0.31 reads past the end of malformed packets, and knows neither colours nor arrays.
#pragma once

#include "engine/base/result.h"
#include "protocol/wire/message.h"

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

struct TimedMessage {
  TimeTag time = kImmediately;
  Message message;
};

// The messages of a packet in their order, bundles opened. A message without a bundle has time kImmediately; in a
// bundle inside a bundle it has the later of the two times, as OSC 1.0 asks of senders. A packet with any fault is
// refused whole; the sentence names the address, if it got that far, and what is wrong. Checked: the length, a multiple
// of 4; that every string ends inside the packet and is padded with zeros; addresses of printable characters; argument
// types of OSC 1.0 and 1.1; the limits above; that nothing is left over.
//
// Elements of an array become arguments like any others. A message without type tags is one without arguments.
Result<std::vector<TimedMessage>> decode_packet(std::span<const std::byte> packet);

}  // namespace ringdown::wire
