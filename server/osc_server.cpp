#include "server/osc_server.h"

#include "protocol/defaults.h"
#include "protocol/pattern.h"
#include "protocol/schema.h"
#include "server/bundles.h"
#include "server/describe.h"
#include "server/session/state.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

namespace ringdown::server {
namespace {

using namespace std::chrono_literals;
using protocol::Fail;
using protocol::Request;

void answer(AnswerPorts& ports, Peer to, const protocol::Reply& reply) {
  if (const auto* refusal = std::get_if<Fail>(&reply)) spdlog::warn("{}: {}", to_text(to.endpoint), refusal->sentence);
  // A sender that does not listen is its own affair.
  ports.send(to, wire::encode(protocol::format(reply)));
}

void answer(AnswerPorts& ports, Peer to, const Result<std::vector<protocol::Reply>>& replies,
            const std::string& address) {
  if (!replies) return answer(ports, to, Fail{address, address + ": " + replies.error().message});
  send_in_bundles(*replies, [&](std::span<const std::byte> packet) { ports.send(to, packet); });
}

bool is_for_recorder(const Request& request) {
  return std::holds_alternative<protocol::RecordStart>(request) ||
         std::holds_alternative<protocol::RecordStop>(request) || std::holds_alternative<protocol::SaveState>(request);
}

Result<std::optional<std::int32_t>> record(const Request& request, const session::Session& session,
                                           session::Recorder* recorder) {
  if (!recorder) return fail(ErrorKind::refused, "this daemon does not record");
  const synth::Frame now = session.rack().mixer().counters().frames;
  if (const auto* save = std::get_if<protocol::SaveState>(&request)) {
    const auto path = session.rack().roots().writable(save->path, session::kStateKind);
    if (!path) return fail(path.error());
    if (const auto saved = session::write_state(session::state_of(session, *recorder), *path); !saved)
      return fail(saved.error());
    return std::nullopt;
  }
  if (const auto* start = std::get_if<protocol::RecordStart>(&request)) {
    const auto path = session.rack().roots().writable(start->path, session::kScoreKind);
    if (!path) return fail(path.error());
    if (const auto started = recorder->start(*path, now); !started) return fail(started.error());
    return std::nullopt;
  }
  const auto count = recorder->stop(now);
  if (!count) return fail(count.error());
  return static_cast<std::int32_t>(*count);
}

}  // namespace

OscServer::OscServer(wire::OscSocket socket, Parts parts)
    : ports_(std::make_shared<AnswerPorts>(AnswerPorts{std::move(socket), parts.stream})),
      parts_(std::move(parts)),
      notifier_(parts_.session, parts_.driver,
                [ports = ports_](Peer to, std::span<const std::byte> packet) { ports->send(to, packet); }),
      clock_(driver_clock(parts_.driver), steady_now_s),
      thread_([this](const std::stop_token& stop) { run(stop); }) {
  if (!parts_.stream) return;
  parts_.stream->start([this](std::span<const std::byte> packet, Peer from) { take_from_stream(packet, from); });
}

void AnswerPorts::send(Peer to, std::span<const std::byte> packet) {
  if (to.connection == 0) {
    static_cast<void>(socket.send_to(to.endpoint, packet));
  } else if (stream) {
    stream->send(to, packet);
  }
}

OscServer::~OscServer() {
  {
    const std::scoped_lock lock(inbox_.mutex);
    inbox_.closed = true;
  }
  inbox_.room.notify_all();
  if (parts_.stream) parts_.stream->stop();
  thread_.request_stop();
  ports_->socket.wake();
}

void OscServer::run(const std::stop_token& stop) {
  wire::Datagram datagram;
  while (!stop.stop_requested()) {
    adopt_priority();
    share_.turn();
    clock_.measure();
    play_what_is_near();
    parts_.session.rack().tell_of_notes();
    const bool holds = parts_.session.holds();
    if (ports_->socket.receive(datagram, holds ? 0ms : schedule_.size() > 0 ? 20ms : 100ms)) {
      handle(datagram.bytes, {datagram.from}, datagram.age_s);
    } else if (holds) {
      parts_.session.flush();
    }
    if (parts_.stream) handle_inbox();
  }
}

// JACK servers come and go, and with them the priority.
void OscServer::adopt_priority() {
  const double now_s = steady_now_s();
  if (now_s - looked_at_s_ < 1) return;
  looked_at_s_ = now_s;
  const int priority = parts_.driver.control_priority();
  if (priority == priority_) return;
  priority_ = priority;
  if (const auto set = share_.set_priority(priority); !set) {
    spdlog::info("OSC has no real-time priority ({}): messages may come late when the machine is busy",
                 set.error().message);
  }
}

void OscServer::take_from_stream(std::span<const std::byte> packet, Peer from) {
  {
    std::unique_lock lock(inbox_.mutex);
    inbox_.room.wait(lock, [this] { return inbox_.closed || inbox_.packets.size() < Inbox::kMost; });
    if (inbox_.closed) return;
    inbox_.packets.push_back({{packet.begin(), packet.end()}, from, steady_now_s()});
  }
  ports_->socket.wake();
}

void OscServer::handle_inbox() {
  std::vector<Inbox::Packet> packets;
  {
    const std::scoped_lock lock(inbox_.mutex);
    packets.swap(inbox_.packets);
  }
  inbox_.room.notify_all();
  for (const Inbox::Packet& packet : packets) handle(packet.bytes, packet.from, steady_now_s() - packet.steady_s);
}

void OscServer::handle(std::span<const std::byte> packet, Peer from, double age_s) {
  const Arrival arrival{from, steady_now_s(), unix_now_s(), age_s};
  notifier_.heard_from(from);
  const auto messages = wire::decode_packet(packet);
  if (!messages) return answer(*ports_, arrival.from, Fail{"", messages.error().message});
  for (const wire::TimedMessage& timed : *messages) {
    const synth::Frame frame = frame_of(timed.time, arrival);
    if (protocol::is_pattern(timed.message.address)) {
      expand(timed.message, frame, arrival.from);
    } else {
      handle(timed.message, frame, arrival.from);
    }
  }
}

synth::Frame OscServer::frame_of(wire::TimeTag time, const Arrival& arrival) const {
  if (time == wire::kImmediately) {
    return clock_.frame_at(arrival.steady_s - arrival.age_s) + latency_frames(parts_.driver, parts_.latency);
  }
  // A tag years away would overflow a frame; kMaxAhead_s refuses it all the same.
  constexpr double kFar_s = 1e6;
  return clock_.frame_at(arrival.steady_s + std::clamp(wire::unix_seconds(time) - arrival.unix_s, -kFar_s, kFar_s));
}

synth::Frame OscServer::horizon() const { return clock_.frame_at(steady_now_s() + kHorizon_s); }

void OscServer::expand(const wire::Message& message, synth::Frame frame, Peer from) {
  const auto names = parts_.session.rack().names();
  const auto addresses = protocol::expand(message.address, *names);
  if (!addresses) return answer(*ports_, from, Fail{message.address, addresses.error().message});
  for (const std::string& address : *addresses) handle({address, message.arguments}, frame, from);
}

void OscServer::handle(const wire::Message& message, synth::Frame frame, Peer from) {
  const std::string& address = message.address;
  const auto request = protocol::parse(message);
  if (!request) return answer(*ports_, from, Fail{address, request.error().message});
  if (session::Session::is_event(*request)) {
    play(*request, frame, address, from);
  } else if (std::holds_alternative<protocol::Status>(*request)) {
    answer(*ports_, from, status());
  } else if (std::holds_alternative<protocol::Version>(*request)) {
    answer(*ports_, from, protocol::VersionReply{"ringdownd", RINGDOWN_VERSION, protocol::kProtocolVersion});
  } else if (const auto* notify = std::get_if<protocol::Notify>(&*request)) {
    confirm(set_notices(*notify, from), address, from);
  } else if (const auto* sound = std::get_if<protocol::WatchSound>(&*request)) {
    confirm(notifier_.watch_sound(from, sound->on), address, from);
  } else if (const auto* watch = std::get_if<protocol::WatchObject>(&*request)) {
    confirm(notifier_.watch_object(from, watch->object, watch->on), address, from);
  } else if (std::holds_alternative<protocol::Quit>(*request)) {
    answer(*ports_, from, protocol::Done{address, std::nullopt});
    parts_.quit();
  } else if (std::holds_alternative<protocol::SetDamper>(*request)) {
    hold(*request, frame, address, from);
  } else {
    post(*request, 0, address, from);
  }
}

void OscServer::confirm(const Result<void>& outcome, const std::string& address, Peer from) {
  if (outcome) return answer(*ports_, from, protocol::Done{address, std::nullopt});
  answer(*ports_, from, Fail{address, address + ": " + outcome.error().message});
}

Result<void> OscServer::set_notices(const protocol::Notify& request, Peer from) {
  if (request.on) return notifier_.subscribe(from, request.rate_hz);
  notifier_.unsubscribe(from);
  return {};
}

void OscServer::play(const Request& request, synth::Frame frame, const std::string& address, Peer from) {
  const auto played = frame <= horizon() ? parts_.session.play(request, frame) : keep(request, frame, address, from);
  if (!played) answer(*ports_, from, Fail{address, address + ": " + played.error().message});
}

// Until its time is near.
Result<void> OscServer::keep(const Request& request, synth::Frame frame, const std::string& address, Peer from) {
  if (auto good = parts_.session.check(request, frame); !good) return good;
  if (schedule_.add({frame, request, address, from})) return {};
  return parts_.session.drop(1, std::to_string(kMaxScheduled) + " timed requests are waiting already");
}

// Played at its time too, but it is the worker who can.
void OscServer::hold(const Request& request, synth::Frame frame, const std::string& address, Peer from) {
  if (frame <= horizon()) return post(request, frame, address, from);
  const auto kept = keep(request, frame, address, from);
  if (!kept) answer(*ports_, from, Fail{address, address + ": " + kept.error().message});
}

void OscServer::play_what_is_near() {
  for (const synth::Frame end = horizon(); schedule_.is_due(end);) {
    const Schedule::Entry entry = schedule_.take();
    if (std::holds_alternative<protocol::SetDamper>(entry.request)) {
      post(entry.request, entry.frame, entry.address, entry.from);
      continue;
    }
    const auto played = parts_.session.play(entry.request, entry.frame);
    if (!played) answer(*ports_, entry.from, Fail{entry.address, entry.address + ": " + played.error().message});
  }
}

// /sync goes the same way as what it waits for.
void OscServer::post(const Request& request, synth::Frame frame, const std::string& address, Peer from) {
  const auto task = [ports = ports_, &session = parts_.session, &driver = parts_.driver, latency = parts_.latency,
                     recorder = parts_.recorder, request, frame, address, from] {
    if (const auto* sync = std::get_if<protocol::Sync>(&request))
      return answer(*ports, from, protocol::Synced{sync->id});
    if (is_question(request)) {
      return answer(
          *ports, from,
          recorder ? answer_to(request, session, *recorder) : fail(ErrorKind::refused, "this daemon keeps no levels"),
          address);
    }
    const auto number = is_for_recorder(request)
                            ? record(request, session, recorder)
                            : session.perform(request, std::max(frame, driver.now() + latency_frames(driver, latency)));
    if (number) return answer(*ports, from, protocol::Done{address, *number});
    answer(*ports, from, Fail{address, address + ": " + number.error().message});
  };
  const bool posted = parts_.worker.post(task);
  if (!posted) answer(*ports_, from, Fail{address, address + ": too many requests are waiting; send fewer at once"});
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
          .xruns = load.xruns,
          .dropped_events = whole(parts_.session.dropped()),
          .late_events = whole(mixer.late.load()),
          .merged_events = whole(parts_.session.merged()),
          .load_p99 = load.p99,
          .misses = load.misses,
          .own_xruns = load.own_xruns,
          .hidden_modes = whole(mixer.hidden_modes.load()),
          .shed = whole(mixer.shed.load()),
          .slowed_s = parts_.session.scene().slowed_s(),
          .recording = parts_.recorder && parts_.recorder->records()};
}

}  // namespace ringdown::server
