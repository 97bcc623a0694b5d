// OSC packets to plain messages and back. The only file that includes liblo is osc_codec.cpp. [any thread but audio]
#pragma once

#include "engine/base/result.h"
#include "protocol/message.h"
#include "server/osc_packet.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::server {

struct TimedMessage {
  TimeTag time = kImmediately;
  protocol::Message message;
};

// The messages of a datagram, in their order; checks first (osc_packet.h), and refuses it whole on any fault.
Result<std::vector<TimedMessage>> decode_packet(std::span<const std::byte> packet);

// A packet for one message. Text ends at its first zero byte, as OSC text does.
std::vector<std::byte> encode(const protocol::Message& message);

// A bundle of messages that all happen at `time`.
std::vector<std::byte> encode_bundle(TimeTag time, std::span<const protocol::Message> messages);

// NTP time of a system_clock time, given as seconds since 1970, and back. Good to about a quarter of a microsecond.
TimeTag time_tag(double unix_s);
double unix_seconds(TimeTag time);

struct OscUrl {
  std::string host;
  std::uint16_t port = 0;
};

// "osc.udp://127.0.0.1:7770" or with a trailing slash. Only osc.udp, and the port must be there.
Result<OscUrl> parse_url(std::string_view url);

}  // namespace ringdown::server
