// Reads OSC packets, byte by byte. [any thread but audio]
//
// liblo's reader is not used, because liblo 0.31 reads past the end of malformed packets and lacks colours and arrays.
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

// Returns the messages of a packet in order, including those inside bundles. A message without a bundle has time
// kImmediately; in nested bundles a message has the latest of their times, as OSC 1.0 asks of senders. A packet with
// any fault is refused whole; the sentence names the fault, and the address if it was read before the fault. These
// rules are checked: the length is a multiple of 4; every string ends inside the packet and is padded with zeros;
// addresses have printable characters; argument types are those of OSC 1.0 and 1.1; the limits above hold; no bytes are
// left over.
//
// Elements of an array become ordinary arguments. A message without type tags has no arguments.
Result<std::vector<TimedMessage>> decode_packet(std::span<const std::byte> packet);

}  // namespace ringdown::wire
