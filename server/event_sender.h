// Events as OSC messages to a daemon, each at its own time: how a simulator outside of it plays it.
//
//   auto sender = EventSender::open("osc.udp://127.0.0.1:7770");
//   lost += sender->send(events, [&](ObjectNumber object) { return names[object]; },
//                        [&](Frame frame) { return start_unix_s + frame / rate_hz; });
//
// [one thread at a time, never audio]
#pragma once

#include "engine/base/result.h"
#include "engine/scene/rest_damping.h"
#include "engine/synth/event.h"
#include "protocol/wire/socket.h"

#include <cstddef>
#include <functional>
#include <span>
#include <string>

namespace ringdown::server {

class EventSender {
 public:
  using NameOf = std::function<std::string(synth::ObjectNumber)>;
  using UnixTimeOf = std::function<double(synth::Frame)>;  // [s] since 1970

  // `url` as in osc.udp://127.0.0.1:7770. Succeeds whether or not a daemon is there: UDP cannot tell.
  static Result<EventSender> open(const std::string& url);

  // Sends events, which stand by frame, in bundles of one time and one Ethernet frame each. Objects go by name.
  // Returns how many could not be sent.
  std::size_t send(std::span<const synth::Event> events, const NameOf& name, const UnixTimeOf& unix_time);

  // Sends what rests on objects, likewise; returns of how many objects it could not.
  std::size_t send(std::span<const scene::RestDamping> dampings, const NameOf& name, const UnixTimeOf& unix_time);

 private:
  EventSender(wire::OscSocket socket, wire::Endpoint to) : socket_(std::move(socket)), to_(to) {}

  wire::OscSocket socket_;
  wire::Endpoint to_;
};

}  // namespace ringdown::server
