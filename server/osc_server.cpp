#include "server/osc_server.h"

#include "protocol/defaults.h"
#include "protocol/pattern.h"
#include "protocol/schema.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

namespace ringdown::server {
namespace {

using namespace std::chrono_literals;
using protocol::Fail;
using protocol::Request;

void answer(OscSocket& socket, Peer to, const protocol::Reply& reply) {
  if (const auto* refusal = std::get_if<Fail>(&reply)) spdlog::warn("{}: {}", to_text(to.endpoint), refusal->sentence);
  // A sender that does not listen is its own affair.
  static_cast<void>(socket.send_to(to.endpoint, encode(protocol::format(reply))));
}

}  // namespace

OscServer::OscServer(OscSocket socket, Parts parts)
    : socket_(std::make_shared<OscSocket>(std::move(socket))),
      parts_(std::move(parts)),
      clock_(driver_clock(parts_.driver), steady_now_s),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

OscServer::~OscServer() {
  thread_.request_stop();
  socket_->wake();
}

void OscServer::run(const std::stop_token& stop) {
  Datagram datagram;
  while (!stop.stop_requested()) {
    clock_.measure();
    play_what_is_near();
    if (socket_->receive(datagram, schedule_.size() > 0 ? 20ms : 100ms)) handle(datagram);
  }
}

void OscServer::handle(const Datagram& datagram) {
  const Arrival arrival{{datagram.from}, steady_now_s(), unix_now_s(), datagram.age_s};
  const auto messages = decode_packet(datagram.bytes);
  if (!messages) return answer(*socket_, arrival.from, Fail{"", messages.error().message});
  for (const TimedMessage& timed : *messages) {
    const protocol::Frame frame = frame_of(timed.time, arrival);
    if (protocol::is_pattern(timed.message.address)) {
      expand(timed.message, frame, arrival.from);
    } else {
      handle(timed.message, frame, arrival.from);
    }
  }
}

protocol::Frame OscServer::frame_of(TimeTag time, const Arrival& arrival) const {
  if (time == kImmediately) {
    return clock_.frame_at(arrival.steady_s - arrival.age_s) + latency_frames(parts_.driver, parts_.latency);
  }
  // A tag years away would overflow a frame; kFarthestAhead_s refuses it all the same.
  constexpr double kFar_s = 1e6;
  return clock_.frame_at(arrival.steady_s + std::clamp(unix_seconds(time) - arrival.unix_s, -kFar_s, kFar_s));
}

protocol::Frame OscServer::horizon() const { return clock_.frame_at(steady_now_s() + kHorizon_s); }

void OscServer::expand(const protocol::Message& message, protocol::Frame frame, Peer from) {
  const auto addresses = protocol::expand(message.address, parts_.session.rack().names());
  if (!addresses) return answer(*socket_, from, Fail{message.address, addresses.error().message});
  for (const std::string& address : *addresses) handle({address, message.arguments}, frame, from);
}

void OscServer::handle(const protocol::Message& message, protocol::Frame frame, Peer from) {
  const std::string& address = message.address;
  const auto request = protocol::parse(message);
  if (!request) return answer(*socket_, from, Fail{address, request.error().message});
  if (Session::is_event(*request)) {
    play(*request, frame, address, from);
  } else if (std::holds_alternative<protocol::Status>(*request)) {
    answer(*socket_, from, status());
  } else if (std::holds_alternative<protocol::Version>(*request)) {
    answer(*socket_, from, protocol::VersionReply{"ringdownd", RINGDOWN_VERSION, protocol::kProtocolVersion});
  } else if (std::holds_alternative<protocol::Quit>(*request)) {
    answer(*socket_, from, protocol::Done{address, std::nullopt});
    parts_.quit();
  } else {
    post(*request, address, from);
  }
}

void OscServer::play(const Request& request, protocol::Frame frame, const std::string& address, Peer from) {
  const bool near = frame <= horizon();
  auto played = near ? parts_.session.play(request, frame) : parts_.session.check(request, frame);
  if (played && !near && !schedule_.add({frame, request, address, from})) {
    played = parts_.session.drop(1, std::to_string(kMostScheduled) + " timed requests are waiting already");
  }
  if (!played) answer(*socket_, from, Fail{address, address + ": " + played.error().message});
}

void OscServer::play_what_is_near() {
  for (const protocol::Frame end = horizon(); schedule_.is_due(end);) {
    const Schedule::Entry entry = schedule_.take();
    const auto played = parts_.session.play(entry.request, entry.frame);
    if (!played) answer(*socket_, entry.from, Fail{entry.address, entry.address + ": " + played.error().message});
  }
}

// /sync goes the same way as what it waits for.
void OscServer::post(const Request& request, const std::string& address, Peer from) {
  const auto task = [socket = socket_, &session = parts_.session, &driver = parts_.driver, latency = parts_.latency,
                     request, address, from] {
    if (const auto* sync = std::get_if<protocol::Sync>(&request))
      return answer(*socket, from, protocol::Synced{sync->id});
    const auto number = session.perform(request, driver.now() + latency_frames(driver, latency));
    if (number) return answer(*socket, from, protocol::Done{address, *number});
    answer(*socket, from, Fail{address, address + ": " + number.error().message});
  };
  const bool posted = parts_.worker.post(task);
  if (!posted) answer(*socket_, from, Fail{address, address + ": too many requests are waiting; send fewer at once"});
}

protocol::StatusReply OscServer::status() const {
  const synth::MixerCounters& mixer = parts_.session.rack().mixer().counters();
  const Driver::Load load = parts_.driver.load();
  const auto whole = [](auto number) { return static_cast<std::int32_t>(number); };
  return {.objects = whole(parts_.session.rack().objects().size()),
          .sounding_objects = whole(mixer.ringing_voices.load()),
          .sounding_modes = whole(mixer.ringing_modes.load()),
          .bodies = whole(parts_.session.scene().body_count()),
          .sample_rate_hz = parts_.driver.sample_rate_hz(),
          .block_frames = whole(parts_.driver.block_frames()),
          .load_mean = load.mean,
          .load_peak = load.peak,
          .xruns = parts_.driver.xruns(),
          .dropped_events = whole(parts_.session.dropped()),
          .late_events = whole(mixer.late.load())};
}

}  // namespace ringdown::server
