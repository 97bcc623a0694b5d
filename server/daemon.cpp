#include "server/daemon.h"

#include "engine/base/folders.h"
#include "protocol/wire/score.h"
#include "server/driver.h"
#include "server/latency.h"
#include "server/nsm_client.h"
#include "server/osc_server.h"
#include "server/query_server.h"
#include "server/remote_strikes.h"
#include "server/service_notice.h"
#include "server/session/file_roots.h"
#include "server/session/note_map.h"
#include "server/session/offline.h"
#include "server/session/recorder.h"
#include "server/session/session.h"
#include "server/session/state.h"
#include "server/worker.h"
#include "server/zeroconf.h"

#include <spdlog/spdlog.h>

#include <csignal>
#include <cstdio>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <mutex>

namespace ringdown::server {
namespace {

using namespace std::chrono_literals;
using protocol::ExitCode;

// Signals that end the daemon: blocked in every thread, taken by the main one with sigtimedwait.
sigset_t ending_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

bool signal_came(std::chrono::milliseconds wait) {
  const sigset_t signals = ending_signals();
  const timespec time{.tv_sec = 0, .tv_nsec = std::chrono::nanoseconds(wait).count()};
  return sigtimedwait(&signals, nullptr, &time) > 0;
}

ExitCode report(const Error& error, ExitCode code) {
  std::fprintf(stderr, "ringdownd: %s\n", error.message.c_str());
  return code;
}

// Keeps the scene a little ahead of the sound, so that its strikes always have a frame to come.
std::jthread start_scene(session::Session& session, const Driver& driver) {
  return std::jthread([&session, &driver](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      const double rate = driver.sample_rate_hz();
      const auto ahead = 2 * latency_frames(driver) + static_cast<synth::Frame>(0.01 * rate);
      const auto target = driver.now() + ahead;
      // In freewheel the driver advances the scene; asked after now(), which then jumps.
      if (!driver.freewheels()) session.scene().advance_to(target, static_cast<synth::Frame>(0.25 * rate));
      std::this_thread::sleep_for(2ms);
    }
  });
}

// The folders that the user named, or else the current one; the presets; those of the files on the command line.
Result<session::FileRoots> file_roots_of(const DaemonOptions& options, const session::State& state) {
  std::vector<std::filesystem::path> folders = options.roots;
  std::error_code error;
  const auto here = std::filesystem::current_path(error);
  const bool is_everything = error || here == here.root_path();  // where services start
  if (folders.empty() && !is_everything) folders.push_back(here);
  if (const auto presets = preset_folder()) folders.push_back(*presets);
  const auto add_folder_of = [&folders](const std::filesystem::path& file) {
    folders.push_back(file.has_parent_path() ? file.parent_path() : std::filesystem::path("."));
  };
  for (const auto& [name, bank] : options.objects) add_folder_of(bank);
  for (const session::State::Object& object : state.objects) add_folder_of(object.bank);
  if (options.scene) add_folder_of(*options.scene);
  if (state.scene) add_folder_of(state.scene->file);
  if (options.state) add_folder_of(*options.state);
  return session::FileRoots::only(folders);
}

// A sample of 1, where no force is named: the object's own weight, in round numbers.
constexpr double kDefaultAcceleration_m_s2 = 10;

Result<void> connect_inputs(session::Rack& rack, const std::vector<DaemonOptions::Input>& inputs) {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const auto object = rack.find({.name = inputs[i].object});
    if (!object) return fail(object.error().kind, "--input: " + object.error().message);
    const session::NoteTable::Strike chosen = session::best_strike(**object);
    const Vec3 force_n = (kDefaultAcceleration_m_s2 / session::kDefaultVelocity_m_s) * chosen.impulse_ns;
    const auto connected = rack.excite(i, {.name = inputs[i].object}, inputs[i].point_m.value_or(chosen.point_m),
                                       inputs[i].force_n.value_or(force_n));
    if (!connected) return fail(connected.error().kind, "--input: " + connected.error().message);
  }
  return {};
}

Result<void> load_what_was_asked_for(session::Session& session, const DaemonOptions& options,
                                     const session::State& state, synth::Frame start) {
  for (const auto& [name, bank] : options.objects) {
    if (const auto loaded = session.rack().load(name, bank); !loaded) return fail(loaded.error());
  }
  if (options.scene) {
    if (const auto loaded = session.scene().load(*options.scene, start); !loaded) return fail(loaded.error());
  }
  if (const auto connected = connect_inputs(session.rack(), options.inputs); !connected) return connected;
  const auto restored = restore(state, session, start);
  if (!restored) return fail(restored.error().kind, options.state->string() + ": " + restored.error().message);
  return {};
}

// What a file that is rendered has no use for.
Result<void> check_render(const DaemonOptions& options) {
  for (const auto& [given, name] :
       {std::pair(options.record.has_value(), "--record"), std::pair(options.capture.has_value(), "--capture"),
        std::pair(options.state.has_value(), "--state"), std::pair(options.notes.has_value(), "--notes"),
        std::pair(options.scene_to.has_value(), "--scene-to")}) {
    if (given)
      return fail(ErrorKind::bad_input, std::string(name) + ": the wav driver only renders; use --driver jack or null");
  }
  return {};
}

ExitCode render_to_file(const DaemonOptions& options) {
  if (const auto good = check_render(options); !good) return report(good.error(), ExitCode::usage);
  const auto recording = session::render_offline({.scene = options.scene,
                                                  .objects = options.objects,
                                                  .seconds = options.seconds,
                                                  .sample_rate_hz = options.sample_rate_hz,
                                                  .block_frames = options.block_frames,
                                                  .sound = options.sound},
                                                 [](double) { return !signal_came(0ms); });
  if (!recording) return protocol::complain(recording.error());
  if (const auto written = session::write_audio(*recording, options.output); !written) {
    return report(written.error(), ExitCode::failure);
  }
  spdlog::info("wrote {}, {:.2f} s", options.output.string(),
               static_cast<double>(recording->left.size()) / recording->sample_rate_hz);
  return ExitCode::ok;
}

Result<std::shared_ptr<OscStream>> open_stream(const DaemonOptions& options) {
  if (!options.tcp_port) return nullptr;
  const auto endpoint = wire::resolve(options.address, *options.tcp_port);
  if (!endpoint) return fail(endpoint.error());
  auto stream = OscStream::listen(*endpoint);
  if (!stream) return fail(stream.error());
  spdlog::info("OSC by TCP on {}:{}", options.address, (*stream)->port());
  return std::shared_ptr<OscStream>(std::move(*stream));
}

Result<std::unique_ptr<QueryServer>> open_query(const DaemonOptions& options, std::uint16_t osc_port,
                                                const session::Rack& rack) {
  if (!options.query_port) return nullptr;
  auto query = QueryServer::listen(*options.query_port,
                                   {options.jack_name, options.address, osc_port, [&rack] { return *rack.names(); }});
  if (query) spdlog::info("OSCQuery on http://{}:{}", options.address, (*query)->port());
  return query;
}

// What shall be written when the session is over.
Result<void> write_results(const DaemonOptions& options, session::Recorder& recorder, synth::Frame end,
                           Captured captured) {
  if (options.record && recorder.records()) {
    if (const auto count = recorder.stop(end); !count) return fail(count.error());
  }
  if (!options.capture) return {};
  if (captured.left_out > 0) {
    spdlog::warn("{} lacks the last {} frames: a capture holds {}", options.capture->string(), captured.left_out,
                 captured.most);
  }
  return session::write_audio(
      {.sample_rate_hz = options.sample_rate_hz, .left = std::move(captured.left), .right = std::move(captured.right)},
      *options.capture);
}

// The worker, for those that start before it or end after it.
class WorkerLine {
 public:
  void connect(Worker* worker) {
    const std::scoped_lock lock(mutex_);
    worker_ = worker;
  }
  bool post(Worker::Task task) {
    const std::scoped_lock lock(mutex_);
    return worker_ && worker_->post(std::move(task));
  }
  // In freewheel, where sound does not wait for it, until it is done.
  bool post_and_wait(Worker::Task task) {
    const auto done = std::make_shared<std::promise<void>>();
    auto future = done->get_future();
    const bool posted = post([task = std::move(task), done] {
      task();
      done->set_value();
    });
    if (posted) future.wait_for(1s);
    return posted;
  }

 private:
  std::mutex mutex_;
  Worker* worker_ = nullptr;
};

// The session manager wants what we are to be kept.
void save_session(Worker& worker, const session::Session& session, const std::filesystem::path& file,
                  const NsmClient::Done& done) {
  const bool posted =
      worker.post([&session, file, done] { done(session::write_state(session::state_of(session), file)); });
  if (!posted) done(fail(ErrorKind::refused, "too many requests are waiting; save again later"));
}

ExitCode serve(const DaemonOptions& options, wire::OscSocket socket, std::unique_ptr<Driver> opened, Captured& captured,
               NsmClient* manager) {
  session::State state;
  if (options.state) {
    auto read = session::read_state(*options.state);
    if (!read) return report(read.error(), ExitCode::bad_input);
    state = std::move(*read);
  }
  std::optional<session::NoteMap> note_map;
  if (options.notes) {
    auto map = session::read_note_map(*options.notes);
    if (!map) return report(map.error(), ExitCode::bad_input);
    note_map = std::move(*map);
  }
  auto roots = file_roots_of(options, state);
  if (!roots) return report(roots.error(), ExitCode::bad_input);
  session::Session session(opened->sample_rate_hz(), std::move(*roots));
  session.rack().set_on_warning([](const std::string& sentence) { spdlog::warn("{}", sentence); });
  apply(options.sound, session.rack().mixer());
  if (options.driver == DaemonOptions::DriverKind::jack) session.rack().mixer().set_budget(options.budget);
  session.merge_within(options.merge_s);
  session.rack().mixer().set_threads(options.threads);
  session.rack().buses().set_mode(options.ports);
  session::Notes notes(session.rack(), std::move(note_map));
  session::Recorder recorder(session.rack(), wire::write_score);
  if (options.record) {
    if (const auto started = recorder.start(*options.record, 0); !started) {
      return report(started.error(), ExitCode::usage);
    }
  }
  auto stream = open_stream(options);
  if (!stream) return report(stream.error(), ExitCode::port_busy);
  const auto query = open_query(options, socket.port(), session.rack());
  if (!query) return report(query.error(), ExitCode::port_busy);
  WorkerLine line;
  std::unique_ptr<Driver> driver = std::move(opened);  // after the session, so that it stops before that goes
  session.rack().set_on_change([&driver] { driver->program_changed(); });
  if (options.scene_to) {
    auto remote = open_remote_strikes(*options.scene_to, session.rack(), *driver);
    if (!remote) return report(remote.error(), ExitCode::usage);
    session.scene().send_to(std::move(*remote));
  }
  session.scene().retune_by([&line, &driver](Worker::Task task) {
    return driver->freewheels() ? line.post_and_wait(std::move(task)) : line.post(std::move(task));
  });
  // A second of silence before the scene starts: the driver may take that long.
  const auto start = static_cast<synth::Frame>(driver->sample_rate_hz());
  if (const auto loaded = load_what_was_asked_for(session, options, state, start); !loaded) {
    return report(loaded.error(), ExitCode::bad_input);
  }
  std::atomic<bool> quit = false;
  const auto started = driver->start(
      {.mixer = session.rack().mixer(),
       .change_sample_rate = [&session](double rate) { session.change_sample_rate(rate); },
       .prepare_offline = [&session](synth::Frame frame) { session.scene().advance_to(frame, std::nullopt); },
       .buses = [&session] { return session.rack().buses().names(); },
       .inputs = [&session] { return session.rack().inputs(); },
       .notes = [&notes] { return notes.table(); },
       .notes_played = session.rack().notes_played()});
  if (!started) {
    return report(started.error(), ExitCode::no_jack);
  }
  std::atomic<std::uint64_t> rounds = 0;  // of the worker
  std::optional<Worker> worker(
      std::in_place, [&session, &rounds] { session.rack().collect(), ++rounds; }, 50ms);
  line.connect(&*worker);
  std::optional<OscServer> server(
      std::in_place, std::move(socket),
      OscServer::Parts{session, *worker, *driver, [&quit] { quit = true; }, options.latency, &recorder, *stream});
  std::jthread scene = start_scene(session, *driver);
  spdlog::info("ready: OSC on {}:{}, {} objects, {:.0f} Hz, blocks of {}, {} kernel", options.address, server->port(),
               session.rack().names()->size(), driver->sample_rate_hz(), driver->block_frames(),
               synth::kernel_target());

  std::optional<Zeroconf> zeroconf;
  if (options.zeroconf) {
    zeroconf.emplace(options.jack_name, server->port(), *stream ? std::optional((*stream)->port()) : std::nullopt);
  }
  if (manager) {
    manager->start([&](const NsmClient::Done& done) { save_session(*worker, session, manager->state_file(), done); });
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(options.seconds.value_or(1e9));
  ServiceNotice service;
  while (!quit && std::chrono::steady_clock::now() < end) {
    service.turn(session.rack().mixer().counters().frames, rounds);
    if (signal_came(50ms)) break;
  }
  service.stopping();
  zeroconf.reset();
  spdlog::info("stopping");
  if (manager) manager->stop();
  scene = {};
  server.reset();
  line.connect(nullptr);
  worker.reset();
  driver.reset();
  const auto written = write_results(options, recorder, session.rack().mixer().counters().frames, std::move(captured));
  if (!written) return report(written.error(), ExitCode::failure);
  return ExitCode::ok;
}

}  // namespace

ExitCode run_daemon(DaemonOptions options) {
  const sigset_t signals = ending_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);  // libjack writes to servers that are gone
  if (options.driver == DaemonOptions::DriverKind::wav) return render_to_file(options);

  const auto endpoint = wire::resolve(options.address, options.port);
  if (!endpoint) return report(endpoint.error(), ExitCode::usage);
  auto socket = wire::OscSocket::bind(*endpoint);
  if (!socket) return report(socket.error(), ExitCode::port_busy);
  if (endpoint->address >> 24 != 127) {
    spdlog::warn("listening on {}: anyone who can reach this address can play, load files and stop the daemon",
                 options.address);
  }
  std::unique_ptr<NsmClient> manager;
  if (const auto url = NsmClient::url()) {
    auto announced = NsmClient::announce(*url);
    if (!announced) return report(announced.error(), ExitCode::failure);
    manager = std::move(*announced);
    options.jack_name = manager->session().client_id;
    std::error_code ignored;
    if (std::filesystem::exists(manager->state_file(), ignored)) options.state = manager->state_file();
  }
  Captured captured;
  auto driver = options.driver == DaemonOptions::DriverKind::jack
                    ? open_jack({.client_name = options.jack_name,
                                 .connect = options.connect,
                                 .wait = options.wait,
                                 .sample_rate_hz = options.sample_rate_hz,
                                 .block_frames = options.block_frames})
                    : open_null(options.sample_rate_hz, options.block_frames, options.capture ? &captured : nullptr);
  if (!driver) return report(driver.error(), ExitCode::no_jack);
  return serve(options, std::move(*socket), std::move(*driver), captured, manager.get());
}

}  // namespace ringdown::server
