// Sends events to a daemon as OSC messages, each with its own time. A simulator outside of the daemon uses it to play
// there.
//
//   auto sender = EventSender::open("osc.udp://127.0.0.1:7770");
//   lost += sender->send(events, [&](ObjectNumber object) { return names[object]; },
//                        [&](Frame frame) { return start_unix_s + frame / rate_hz; });
//
// [one thread at a time, never audio]
#pragma once

#include "engine/base/result.h"
#include "engine/scene/contact/rest_damping.h"
#include "engine/synth/events/event.h"
#include "protocol/wire/socket.h"

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <utility>

namespace ringdown::server {

class EventSender {
 public:
  using NameOf = std::function<std::string(synth::ObjectNumber)>;
  using UnixTimeOf = std::function<double(synth::Frame)>;  // [s] since 1970

  // `url` is like osc.udp://127.0.0.1:7770. Succeeds whether or not a daemon is there: UDP cannot tell.
  static Result<EventSender> open(const std::string& url);

  // Sends events, which must be in order of frames, in bundles: each has one time and fits into one Ethernet frame.
  // Messages name objects by their names. Returns how many events could not be sent.
  std::size_t send(std::span<const synth::Event> events, const NameOf& name, const UnixTimeOf& unix_time);

  // Sends the dampers of resting contacts. Returns the number of objects for which that failed.
  std::size_t send(std::span<const scene::RestDamping> dampings, const NameOf& name, const UnixTimeOf& unix_time);

 private:
  EventSender(wire::OscSocket socket, wire::Endpoint to) : socket_(std::move(socket)), to_(to) {}

  wire::OscSocket socket_;
  wire::Endpoint to_;
};

}  // namespace ringdown::server
