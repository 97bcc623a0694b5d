#include "server/osc_server.h"

#include "engine/base/atomic_file.h"
#include "engine/base/version.h"
#include "engine/base/within_memory.h"
#include "protocol/defaults.h"
#include "protocol/pattern.h"
#include "protocol/schema.h"
#include "server/describe.h"
#include "server/log.h"
#include "server/session/scene_save.h"
#include "server/session/state.h"
#include "server/turns.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <type_traits>
#include <utility>
#include <vector>

namespace ringdown::server {
namespace {

using namespace std::chrono_literals;
using protocol::Fail;

// The outcome of a request that is answered by /done, with a number for some requests.
using Outcome = Result<std::optional<std::int32_t>>;

// An untimed break lies this far ahead, because its pieces must not be late and it takes a while to compute.
constexpr double kBreakLead_s = 0.005;

// Carries out requests of the file lane. [worker]
struct WriteFile {
  const session::Session& session;
  session::Recorder* recorder;     // null: nothing can be recorded
  session::SoundCapture* capture;  // null: no sound can

  Outcome operator()(const protocol::SaveState& save) const {
    const auto path = session.roots().writable(save.path, session::kStateKind);
    if (!path) return fail(path);
    if (const auto saved = session::write_state(session::state_of(session), *path); !saved) return fail(saved);
    return std::nullopt;
  }

  Outcome operator()(const protocol::SaveScene& save) const {
    session::WrittenKind kind = session::kSceneKind;
    if (!save.replace) kind.mark = {};
    const auto path = session.roots().writable(save.path, kind);
    if (!path) return fail(path);
    if (const auto saved = session::save_scene(session, *path); !saved) return fail(saved);
    return std::nullopt;
  }

  Outcome operator()(const protocol::CaptureStart& start) const {
    if (!capture) return no_recorder();
    const auto path = session.roots().writable(start.path, session::kSoundKind);
    if (!path) return fail(path);
    if (const auto started = capture->start({*path}); !started) return fail(started);
    return std::nullopt;
  }

  Outcome operator()(const protocol::CaptureStop&) const {
    if (!capture) return no_recorder();
    const auto frames = capture->stop();
    if (!frames) return fail(frames);
    return static_cast<std::int32_t>(*frames);
  }

  Outcome operator()(const protocol::RecordStart& start) const {
    if (!recorder) return no_recorder();
    const auto path = session.roots().writable(start.path, session::kScoreKind);
    if (!path) return fail(path);
    if (const auto good = check_writable(*path); !good) return fail(good);
    if (const auto started = recorder->start(*path, now()); !started) return fail(started);
    return std::nullopt;
  }

  Outcome operator()(const protocol::RecordStop& stop) const {
    if (!recorder) return no_recorder();
    std::optional<std::filesystem::path> other;
    if (stop.path) {
      auto path = session.roots().writable(*stop.path, session::kScoreKind);
      if (!path) return fail(path);
      other = std::move(*path);
    }
    const auto count = recorder->stop(now(), std::move(other));
    if (!count && recorder->records()) {
      return fail(count.error().kind,
                  count.error().message + "; the recording continues: name another file with /record/stop");
    }
    if (!count) return fail(count);
    return static_cast<std::int32_t>(*count);
  }

 private:
  static tl::unexpected<Error> no_recorder() { return fail(ErrorKind::refused, "this daemon does not record"); }
  [[nodiscard]] synth::Frame now() const { return session.rack().mixer().counters().frames; }
};

}  // namespace

OscServer::OscServer(wire::OscSocket socket, Parts parts)
    : ports_(std::make_shared<AnswerPorts>(std::move(socket), parts.stream)),
      parts_(std::move(parts)),
      notifier_(parts_.session, parts_.driver,
                [ports = ports_](Peer to, std::span<const std::byte> packet) { ports->send(to, packet); }),
      clock_(driver_clock(parts_.driver), parts_.clocks.steady_s),
      thread_([this](const std::stop_token& stop) { run(stop); }) {
  if (!parts_.stream) return;
  parts_.stream->start([this](std::span<const std::byte> packet, Peer from) { take_from_stream(packet, from); });
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
  take_turns("serve OSC", stop, [&] {
    adopt_priority();
    share_.turn();
    clock_.measure();
    carry_out_what_is_near();
    const bool holds_strikes = parts_.session.holds_strikes();
    if (ports_->socket.receive(datagram, holds_strikes ? 0ms : schedule_.size() > 0 ? 20ms : 100ms)) {
      handle(datagram.bytes, {datagram.from}, datagram.age_s);
    } else if (holds_strikes) {
      parts_.session.flush();
    }
    if (parts_.stream) handle_inbox();
    ports_->refusals.report();
  });
  parts_.session.flush();
}

// Asks the driver once in a second, because its priority changes when another JACK server takes over.
void OscServer::adopt_priority() {
  const double now_s = parts_.clocks.steady_s();
  if (now_s - looked_at_s_ < 1) return;
  looked_at_s_ = now_s;
  const int priority = parts_.driver.control_priority();
  if (priority == priority_) return;
  priority_ = priority;
  if (const auto set = share_.set_priority(priority); !set) {
    log_info("OSC has no real-time priority (" + set.error().message +
             "): messages may come late when the machine is busy");
  }
}

void OscServer::take_from_stream(std::span<const std::byte> packet, Peer from) {
  {
    std::unique_lock lock(inbox_.mutex);
    inbox_.room.wait(lock, [this] { return inbox_.closed || inbox_.packets.size() < Inbox::kMax; });
    if (inbox_.closed) return;
    inbox_.packets.push_back({{packet.begin(), packet.end()}, from, parts_.clocks.steady_s()});
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
  for (const Inbox::Packet& packet : packets)
    handle(packet.bytes, packet.from, parts_.clocks.steady_s() - packet.steady_s);
}

void OscServer::handle(std::span<const std::byte> packet, Peer from, double age_s) {
  const Arrival arrival{from, parts_.clocks.steady_s(), parts_.clocks.unix_s(), age_s};
  notifier_.heard_from(from);
  const auto messages = wire::decode_packet(packet);
  if (!messages) return answer(*ports_, arrival.from, Fail{"", messages.error().message});
  for (const wire::TimedMessage& timed : *messages) {
    look_at_epoch(timed.time, arrival);
    const synth::Frame frame = frame_of(timed.time, arrival);
    if (protocol::is_pattern(timed.message.address)) {
      expand(timed.message, frame, arrival.from);
    } else {
      handle(timed.message, frame, arrival.from);
    }
  }
}

// A sender that takes seconds since 1970 for OSC's is 70 years late in all that it sends. It is told once.
void OscServer::look_at_epoch(wire::TimeTag time, const Arrival& arrival) {
  constexpr double kDay_s = 86400;
  const auto seconds = static_cast<double>(time >> 32);
  if (told_of_epoch_ || std::abs(seconds - arrival.unix_s) > kDay_s) return;
  told_of_epoch_ = true;
  answer(*ports_, arrival.from,
         Fail{"#bundle",
              "a time tag counts its seconds from 1970, so its bundle is played at once; OSC counts from 1900: add "
              "2208988800"});
}

synth::Frame OscServer::frame_of(wire::TimeTag time, const Arrival& arrival) const {
  if (time == wire::kImmediately) {
    return clock_.frame_at(arrival.steady_s - arrival.age_s) + latency_frames(parts_.driver, parts_.latency);
  }
  // A tag years away would overflow a frame number. It is clamped here and refused by kMaxAhead_s later.
  constexpr double kFar_s = 1e6;
  return clock_.frame_at(arrival.steady_s + std::clamp(wire::unix_seconds(time) - arrival.unix_s, -kFar_s, kFar_s));
}

synth::Frame OscServer::horizon() const { return clock_.frame_at(parts_.clocks.steady_s() + kHorizon_s); }

void OscServer::expand(const wire::Message& message, synth::Frame frame, Peer from) {
  const auto names = parts_.session.rack().names();
  const auto addresses = protocol::expand(message.address, *names);
  if (!addresses) return answer(*ports_, from, Fail{message.address, addresses.error().message});
  for (const std::string& address : *addresses) handle({address, message.arguments}, frame, from);
}

// Passes a request to the function for its lane (protocol/lanes.h).
void OscServer::handle(const wire::Message& message, synth::Frame frame, Peer from) {
  const std::string& address = message.address;
  auto request = protocol::parse(message);
  if (!request) return answer(*ports_, from, Fail{address, request.error().message});
  visit(Overloaded{
            [&](protocol::MixerRequest&& r) { take(std::move(r), frame, address, from); },
            [&](protocol::TimedWorkerRequest&& r) { take(std::move(r), frame, address, from); },
            [&](const protocol::WorkerRequest& r) { perform(r, 0, address, from); },
            [&](const protocol::FileRequest& r) { write(r, address, from); },
            [&](const protocol::Question& r) { ask(r, address, from); },
            [&](const protocol::SubscriptionRequest& r) { subscribe(r, address, from); },
            [&](const protocol::DaemonRequest& r) { answer_at_once(r, address, from); },
        },
        protocol::in_its_lane(*std::move(request)));
}

// Carries a request out if its frame is near; otherwise puts it into the schedule.
void OscServer::take(Schedule::Request request, synth::Frame frame, const std::string& address, Peer from) {
  if (frame <= horizon()) return carry_out(request, frame, address, from);
  const auto waits = schedule(std::move(request), frame, address, from);
  if (!waits) answer(*ports_, from, Fail{address, address + ": " + waits.error().message});
}

Result<void> OscServer::schedule(Schedule::Request request, synth::Frame frame, const std::string& address, Peer from) {
  auto good = visit([&](const auto& r) { return parts_.session.check(r, frame); }, request);
  if (!good) return good;
  if (schedule_.add({frame, std::move(request), address, from})) return {};
  return parts_.session.drop(1, formatted("{} timed requests are waiting already", kMaxScheduled));
}

void OscServer::carry_out(const Schedule::Request& request, synth::Frame frame, const std::string& address, Peer from) {
  visit(Overloaded{
            [&](const protocol::MixerRequest& r) {
              const auto played = parts_.session.play(r, frame);
              if (!played) answer(*ports_, from, Fail{address, address + ": " + played.error().message});
            },
            [&](const protocol::TimedWorkerRequest& r) { perform(r, frame, address, from); },
        },
        request);
}

void OscServer::carry_out_what_is_near() {
  for (const synth::Frame end = horizon(); schedule_.is_due(end);) {
    const Schedule::Entry entry = schedule_.take();
    carry_out(entry.request, entry.frame, entry.address, entry.from);
  }
}

// Posts a request that changes objects or the scene to the worker. The request takes effect at `frame`, or at the
// earliest audible frame.
template <class Lane>
void OscServer::perform(const Lane& request, synth::Frame frame, const std::string& address, Peer from) {
  post(
      [ports = ports_, &session = parts_.session, &driver = parts_.driver, latency = parts_.latency, request, frame,
       address, from] {
        const protocol::BreakObject* blow = nullptr;
        if constexpr (std::is_same_v<Lane, protocol::TimedWorkerRequest>)
          blow = request.template get_if<protocol::BreakObject>();
        const double lead_s = blow ? kBreakLead_s : 0;
        const synth::Frame soon = driver.now() + latency_frames(driver, latency) +
                                  static_cast<synth::Frame>(std::llround(lead_s * driver.sample_rate_hz()));
        const auto done = session.perform(request, std::max(frame, soon));
        if (blow && done) {
          if (const auto broken = session.breakage().report(blow->object))
            return answer(*ports, from, Result<std::vector<protocol::Reply>>(news_of(*broken)), address);
        }
        answer(*ports, from, done, address);
      },
      address, from);
}

// Everything sent before the request belongs into the file, including strikes that wait to be merged with others.
void OscServer::write(const protocol::FileRequest& request, const std::string& address, Peer from) {
  parts_.session.flush();
  post(
      [ports = ports_, &session = parts_.session, recorder = parts_.recorder, capture = parts_.capture, request,
       address, from] {
        answer(*ports, from, visit(WriteFile{session, recorder, capture}, request), address);
      },
      address, from);
}

void OscServer::ask(const protocol::Question& question, const std::string& address, Peer from) {
  post([ports = ports_, &session = parts_.session, question, address,
        from] { answer(*ports, from, answer_to(question, session), address); },
       address, from);
}

void OscServer::subscribe(const protocol::SubscriptionRequest& request, const std::string& address, Peer from) {
  const Result<void> done = visit(
      Overloaded{
          [&](const protocol::Notify& notify) -> Result<void> {
            if (notify.on) return notifier_.subscribe(from, notify.rate_hz);
            notifier_.unsubscribe(from);
            return {};
          },
          [&](const protocol::WatchSound& sound) { return notifier_.watch_sound(from, sound.on); },
          [&](const protocol::WatchObject& watch) { return notifier_.watch_object(from, watch.object, watch.on); },
      },
      request);
  answer(*ports_, from, done ? Outcome(std::nullopt) : Outcome(fail(done)), address);
}

void OscServer::answer_at_once(const protocol::DaemonRequest& request, const std::string& address, Peer from) {
  visit(Overloaded{
            [&](const protocol::Status&) { answer(*ports_, from, status()); },
            [&](const protocol::Version&) {
              answer(*ports_, from, protocol::VersionReply{"ringdownd", kVersion, protocol::kProtocolVersion});
            },
            [&](const protocol::Quit&) {
              answer(*ports_, from, protocol::Done{address, std::nullopt});
              parts_.quit();
            },
        },
        request);
}

// Posts a task to the worker. The task answers the sender itself; if the worker has no room for the task, or there is
// not enough memory, post() answers.
void OscServer::post(Worker::Task task, const std::string& address, Peer from) {
  const bool posted = parts_.worker.post([task = std::move(task), ports = ports_, address, from] {
    const auto done = within_memory("carry it out", [&task]() -> Result<void> {
      task();
      return {};
    });
    if (!done) answer(*ports, from, Fail{address, address + ": " + done.error().message});
  });
  if (posted) return;
  answer(*ports_, from, Fail{address, address + ": too many requests are waiting; send fewer at once"});
}

protocol::StatusReply OscServer::status() const {
  const synth::MixerCounters& mixer = parts_.session.rack().mixer().counters();
  const Driver::Load load = parts_.driver.load();
  const auto whole = [](auto number) { return static_cast<std::int32_t>(number); };
  const auto captured = parts_.capture ? parts_.capture->progress() : std::nullopt;
  return {.objects = whole(parts_.session.rack().names()->size()),
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
          .hidden_modes = whole(mixer.muted_modes.load()),
          .shed = whole(mixer.shed.load()),
          .slowed_s = parts_.session.scene().lost().slowed_s,
          .skipped_s = load.skipped_s,
          .recording = parts_.recorder && parts_.recorder->records(),
          .captured_s = captured ? captured->seconds : 0,
          .full_scale_pa = parts_.session.rack().mixer().settings().full_scale_pa,
          .limited = whole(mixer.limited.load()),
          .coupled_objects = whole(mixer.coupled_voices.load()),
          .psi = static_cast<double>(mixer.psi_over_truth.load()),
          .capture = captured ? std::optional(captured->path) : std::nullopt};
}

}  // namespace ringdown::server
