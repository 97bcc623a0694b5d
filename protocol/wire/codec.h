// Plain messages to OSC packets, by liblo, and what else belongs to OSC: time tags and addresses of daemons. The only
// file that includes liblo is codec.cpp; packet.h reads packets. [any thread but audio]
//
// More of liblo is not used, because of what liblo 0.31 does:
//
// - It converts an argument to the type that a method was registered with, and turns NaN or 1e20 into the integer 0: a
//   request for object NaN would reach object 0. protocol/schema.h converts strictly instead, and refuses.
// - Its server always listens on all interfaces. socket.h binds one address, by default 127.0.0.1.
// - Its queue of bundles for later is unbounded. server/schedule.h holds a bounded one.
// - It compares an address with each registered method in turn. protocol/schema.h looks it up.
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

// A packet for one message. Text ends at its first zero byte, as OSC text does. A Tag is written as I or N.
std::vector<std::byte> encode(const Message& message);

// A bundle of messages that all happen at `time`.
std::vector<std::byte> encode_bundle(TimeTag time, std::span<const Message> messages);

// NTP time of a system_clock time, given as seconds since 1970, and back. Good to about a quarter of a microsecond.
TimeTag time_tag(double unix_s);
double unix_seconds(TimeTag time);

struct OscUrl {
  std::string host;
  std::uint16_t port = 0;
};

// "osc.udp://127.0.0.1:7770" or "osc.udp://[::1]:7770", or with a trailing slash. Only osc.udp, and the port must be
// there.
Result<OscUrl> parse_url(std::string_view url);

}  // namespace ringdown::wire
