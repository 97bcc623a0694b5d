// Encodes plain messages as OSC packets, by liblo, and converts time tags and addresses of daemons. Only codec.cpp
// includes liblo; packet.h reads packets. [any thread but audio]
//
// Other parts of liblo 0.31 are not used:
//
// - liblo converts an argument to the type with which a method was registered, and turns NaN or 1e20 into the integer
// 0:
//   a request for object NaN would reach object 0. protocol/schema.h converts strictly instead, and refuses.
// - liblo's server always listens on all interfaces. socket.h binds one address, by default 127.0.0.1.
// - liblo's queue of bundles for later is unbounded. server/schedule.h has a bounded queue.
// - liblo compares an address with each registered method in turn. protocol/schema.h looks the address up.
#pragma once

#include "engine/base/result.h"
#include "protocol/wire/message.h"
#include "protocol/wire/packet.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::wire {

// Encodes one message as a packet. Text ends at its first zero byte, as OSC text does. A Tag is written as I or N.
std::vector<std::byte> encode(const Message& message);

// Encodes a bundle of messages that all happen at `time`.
std::vector<std::byte> encode_bundle(TimeTag time, std::span<const Message> messages);

// Convert between seconds since 1970 (system_clock) and NTP time, to about a quarter of a microsecond.
TimeTag time_tag(double unix_s);
double unix_seconds(TimeTag time);

struct OscUrl {
  std::string host;
  std::uint16_t port = 0;
};

// Parses "osc.udp://127.0.0.1:7770" or "osc.udp://[::1]:7770", with or without a trailing slash. Fails for other
// schemes and without a port.
Result<OscUrl> parse_url(std::string_view url);

}  // namespace ringdown::wire
