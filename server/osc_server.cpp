#include "server/osc_server.h"

#include "protocol/defaults.h"
#include "protocol/schema.h"

#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>

namespace ringdown::server {
namespace {

using namespace std::chrono_literals;
using protocol::Fail;
using protocol::Request;

double unix_now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

void answer(OscSocket& socket, Endpoint to, const protocol::Reply& reply) {
  if (const auto* refusal = std::get_if<Fail>(&reply)) spdlog::warn("{}: {}", to_text(to), refusal->sentence);
  // A sender that does not listen is its own affair.
  static_cast<void>(socket.send_to(to, encode(protocol::format(reply))));
}

}  // namespace

OscServer::OscServer(OscSocket socket, Parts parts)
    : socket_(std::make_shared<OscSocket>(std::move(socket))),
      parts_(std::move(parts)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

OscServer::~OscServer() {
  thread_.request_stop();
  socket_->wake();
}

void OscServer::run(const std::stop_token& stop) {
  Datagram datagram;
  while (!stop.stop_requested()) {
    if (socket_->receive(datagram, 1000ms)) handle(datagram);
  }
}

void OscServer::handle(const Datagram& datagram) {
  const Arrival arrival{datagram.from, parts_.driver.now(), unix_now_s()};
  const auto messages = decode_packet(datagram.bytes);
  if (!messages) return answer(*socket_, datagram.from, Fail{"", messages.error().message});
  for (const TimedMessage& timed : *messages) handle(timed, arrival);
}

protocol::Frame OscServer::frame_of(TimeTag time, const Arrival& arrival) const {
  if (time == kImmediately) return arrival.frame + latency_frames(parts_.driver);
  const double ahead_s = unix_seconds(time) - arrival.unix_s;
  return arrival.frame + std::llround(ahead_s * parts_.driver.sample_rate_hz());
}

void OscServer::handle(const TimedMessage& timed, const Arrival& arrival) {
  const std::string& address = timed.message.address;
  const Endpoint from = arrival.from;
  const auto request = protocol::parse(timed.message);
  if (!request) return answer(*socket_, from, Fail{address, request.error().message});
  if (Session::is_event(*request)) {
    const auto played = parts_.session.play(*request, frame_of(timed.time, arrival));
    if (!played) answer(*socket_, from, Fail{address, address + ": " + played.error().message});
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

// /sync goes the same way as what it waits for.
void OscServer::post(const Request& request, const std::string& address, Endpoint from) {
  const auto task = [socket = socket_, &session = parts_.session, &driver = parts_.driver, request, address, from] {
    if (const auto* sync = std::get_if<protocol::Sync>(&request))
      return answer(*socket, from, protocol::Synced{sync->id});
    const auto number = session.perform(request, driver.now() + latency_frames(driver));
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
