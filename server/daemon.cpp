#include "server/daemon.h"

#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "protocol/wire/score.h"
#include "server/latency.h"
#include "server/log.h"
#include "server/osc_server.h"
#include "server/remote_strikes.h"
#include "server/session/file_roots.h"
#include "server/session/offline.h"
#include "server/turns.h"
#include "server/zeroconf.h"

#include <chrono>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

namespace ringdown::server {
namespace {

using namespace std::chrono_literals;

// The folders that the user named, or else the current one; the presets; the user's own banks; the folders of the files
// on the command line.
Result<session::FileRoots> file_roots_of(const DaemonOptions& options, const session::State& state,
                                         const std::optional<session::NoteMap>& notes) {
  std::vector<std::filesystem::path> folders = options.roots;
  std::error_code error;
  const auto here = std::filesystem::current_path(error);
  const bool is_everything = error || here == here.root_path();  // where services start
  if (folders.empty() && !is_everything) folders.push_back(here);
  if (const auto presets = preset_folder()) folders.push_back(*presets);
  if (const auto own = own_bank_folder()) folders.push_back(*own);
  const auto add_folder_of = [&folders](const std::filesystem::path& file) {
    folders.push_back(file.has_parent_path() ? file.parent_path() : std::filesystem::path("."));
  };
  for (const auto& [name, bank] : options.objects) add_folder_of(bank);
  for (const session::State::Object& object : state.objects) add_folder_of(object.bank);
  if (options.scene) add_folder_of(*options.scene);
  if (state.scene) add_folder_of(state.scene->file);
  if (options.state) add_folder_of(*options.state);
  if (notes && !notes->banks.empty()) folders.push_back(options.notes->parent_path() / notes->banks);
  return session::FileRoots::only(folders);
}

Result<std::unique_ptr<Driver>> open_driver(const DaemonOptions& options, std::shared_ptr<session::MidiPlayer> midi) {
  if (options.driver != DaemonOptions::DriverKind::jack) return open_null(options.sample_rate_hz, options.block_frames);
  return open_jack({.client_name = options.jack_name,
                    .connect = options.connect,
                    .keyboard = options.connect && !options.keyboard ? "" : options.keyboard,
                    .wait = options.wait,
                    .sample_rate_hz = options.sample_rate_hz,
                    .block_frames = options.block_frames},
                   std::move(midi));
}

Result<std::shared_ptr<OscStream>> open_stream(const DaemonOptions& options) {
  if (!options.tcp_port) return nullptr;
  const auto endpoint = wire::resolve(options.address, *options.tcp_port);
  if (!endpoint) return fail(endpoint);
  auto stream = OscStream::listen(*endpoint);
  if (!stream) return fail(stream);
  log_info(formatted("OSC by TCP on {}:{}", options.address, (*stream)->port()));
  return std::shared_ptr<OscStream>(std::move(*stream));
}

Result<std::unique_ptr<QueryServer>> open_query(const DaemonOptions& options, std::uint16_t osc_port,
                                                const session::Rack& rack) {
  if (!options.query_port) return nullptr;
  auto query = QueryServer::listen(*options.query_port,
                                   {options.jack_name, options.address, osc_port, [&rack] { return rack.names(); }});
  if (query) log_info(formatted("OSCQuery on http://{}:{}", options.address, (*query)->port()));
  return query;
}

// Joins the session manager that started us, which names our JACK client and our state file.
Result<std::unique_ptr<NsmClient>> join_manager(DaemonOptions& options) {
  const auto url = NsmClient::url();
  if (!url) return nullptr;
  auto manager = NsmClient::announce(*url);
  if (!manager) return fail(ErrorKind::refused, manager.error().message);
  options.jack_name = (*manager)->session().client_id;
  std::error_code ignored;
  if (std::filesystem::exists((*manager)->state_file(), ignored)) options.state = (*manager)->state_file();
  return manager;
}

// Writes the score of --record where the user says, and that of a message at the path that was checked.
session::Recorder::Write score_writer(const std::optional<std::filesystem::path>& record) {
  return [record](std::span<const wire::ScoreEvent> score, const std::filesystem::path& path) {
    return path == record ? write_output(path, wire::encode_score(score)) : wire::write_score(score, path);
  };
}

// Keeps the scene a little ahead of the sound, so that its strikes have frames that are still to come.
std::jthread start_scene(session::Session& session, const Driver& driver) {
  return std::jthread([&session, &driver](const std::stop_token& stop) {
    take_turns("advance the scene", stop, [&] {
      const double rate = driver.sample_rate_hz();
      const auto ahead = 2 * latency_frames(driver) + static_cast<synth::Frame>(0.01 * rate);
      const auto target = driver.now() + ahead;
      // In freewheel the driver advances the scene. freewheels() is asked after now(), because now() jumps then.
      const auto slack = static_cast<synth::Frame>(0.25 * rate);
      while (!driver.freewheels() && session.scene().step_towards(target, slack) && !stop.stop_requested()) continue;
      std::this_thread::sleep_for(2ms);
    });
  });
}

// In freewheel the sound waits for a capture to take it, no longer than 2 s: the disk may hang.
void wait_for_capture(synth::Mixer& mixer) {
  constexpr std::size_t kBlock = 8192;  // the longest of JACK's
  for (int turn = 0; turn < 2000 && !mixer.capture_tap().takes(kBlock); ++turn) std::this_thread::sleep_for(1ms);
}

}  // namespace

struct Daemon::Ports {
  wire::OscSocket socket;
  std::unique_ptr<NsmClient> manager;
  std::shared_ptr<session::MidiPlayer> midi;
  std::unique_ptr<Driver> driver;
  std::shared_ptr<OscStream> stream;
};

struct Daemon::Files {
  session::State state;
  std::optional<session::NoteMap> notes;
  session::FileRoots roots;
};

// The daemon's own threads, in the order in which they start; they end in the opposite order.
struct Daemon::Service {
  Service(Daemon& daemon, wire::OscSocket socket);
  ~Service();

  NsmClient* const manager;  // the daemon's; null: none
  Worker worker;
  WorkerLine::Connection worker_connection;
  OscServer server;
  std::jthread scene;
  std::optional<Zeroconf> zeroconf;
};

Daemon::Service::Service(Daemon& daemon, wire::OscSocket socket)
    : manager(daemon.manager_.get()),
      worker([&daemon] { daemon.do_chores(); }, 10ms),
      worker_connection(daemon.worker_line_, worker),
      server(std::move(socket),
             OscServer::Parts{daemon.session_, worker, *daemon.driver_, [&daemon] { daemon.quits_ = true; },
                              daemon.options_.latency, &daemon.recorder_, &daemon.capture_, daemon.stream_}),
      scene(start_scene(daemon.session_, *daemon.driver_)) {
  const DaemonOptions& options = daemon.options_;
  if (options.zeroconf) {
    zeroconf.emplace(options.jack_name, server.port(),
                     daemon.stream_ ? std::optional(daemon.stream_->port()) : std::nullopt);
  }
  if (!manager) return;
  manager->start([&daemon, this](const NsmClient::Done& done) {
    const bool posted = worker.post(
        [&daemon, done, file = manager->state_file()] { done(write_state(state_of(daemon.session_), file)); });
    if (!posted) done(fail(ErrorKind::refused, "too many requests are waiting; save again later"));
  });
}

Daemon::Service::~Service() {
  if (manager) manager->stop();  // it asks the worker to save
}

Result<Daemon::Ports> Daemon::open_ports(DaemonOptions& options) {
  const auto endpoint = wire::resolve(options.address, options.port);
  if (!endpoint) return fail(ErrorKind::usage, endpoint.error().message);
  if (endpoint->is_multicast()) {
    return fail(ErrorKind::usage, "--address " + options.address +
                                      " is a multicast address, which the daemon does not join; name an address of "
                                      "this computer, or 0.0.0.0 for all of them");
  }
  auto socket = wire::OscSocket::serve(*endpoint);
  if (!socket) return fail(socket);
  if (!endpoint->is_loopback()) {
    log_warning("listening on " + options.address +
                ": anyone who can reach this address can play, load files and stop the daemon");
  }
  auto manager = join_manager(options);
  if (!manager) return fail(manager);
  auto midi = std::make_shared<session::MidiPlayer>();
  auto driver = open_driver(options, midi);
  if (!driver) return fail(driver);
  auto stream = open_stream(options);
  if (!stream) return fail(stream);
  return Ports{std::move(*socket), std::move(*manager), std::move(midi), std::move(*driver), std::move(*stream)};
}

Result<Daemon::Files> Daemon::read_files(const DaemonOptions& options) {
  session::State state;
  if (options.state) {
    auto read = session::read_state(*options.state);
    if (!read) return fail(read);
    state = std::move(*read);
  }
  std::optional<session::NoteMap> notes;
  if (options.notes) {
    auto map = session::read_note_map(*options.notes);
    if (!map) return fail(map);
    notes = std::move(*map);
  }
  auto roots = file_roots_of(options, state, notes);
  if (!roots) return fail(roots);
  return Files{std::move(state), std::move(notes), std::move(*roots)};
}

Result<std::unique_ptr<Daemon>> Daemon::start(DaemonOptions options) {
  auto ports = open_ports(options);
  if (!ports) return fail(ports);
  auto files = read_files(options);
  if (!files) return fail(files);
  wire::OscSocket socket = std::move(ports->socket);
  std::unique_ptr<Daemon> daemon(new Daemon(std::move(options), std::move(*ports), std::move(*files)));
  if (const auto ready = daemon->prepare(socket.port()); !ready) return fail(ready);
  if (const auto plays = daemon->play(std::move(socket)); !plays) return fail(plays);
  return daemon;
}

Daemon::Daemon(DaemonOptions options, Ports ports, Files files)
    : options_(std::move(options)),
      state_(std::move(files.state)),
      manager_(std::move(ports.manager)),
      session_(ports.driver->sample_rate_hz(), std::move(files.roots)),
      notes_(session_.rack(), files.notes),
      midi_(std::move(ports.midi)),
      tuner_(session_.rack(), midi_->tuning(), std::move(files.notes)),
      recorder_(session_.rack(), score_writer(options_.record)),
      capture_(session_.rack()),
      stream_(std::move(ports.stream)),
      driver_(std::move(ports.driver)) {
  configure();
}

Daemon::~Daemon() = default;

void Daemon::do_chores() {
  tuner_.catch_up();
  for (const std::string& sentence : notes_.set_levels(session_.rack())) log_warning(sentence);
  session_.rack().collect();
  ++worker_rounds_;
}

void Daemon::configure() {
  session::Rack& rack = session_.rack();
  rack.warn = log_warning;
  Driver& driver = *driver_;  // the driver itself uses it while it ends, when driver_ is null already
  rack.observers().set_on_change([&driver] { driver.program_changed(); });
  synth::MixerSettings settings = options_.mixer;
  if (options_.driver != DaemonOptions::DriverKind::jack) settings.budget = 0;
  rack.mixer().configure(settings);
  rack.buses().set_mode(options_.ports);
  session_.merge_within(options_.merge_s);
  session_.scene().retune_by([this, &driver](Worker::Task task) {
    return driver.freewheels() ? worker_line_.post_and_wait(std::move(task)) : worker_line_.post(std::move(task));
  });
}

// Everything that can be refused before any sound is made.
Result<void> Daemon::prepare(std::uint16_t osc_port) {
  if (options_.record) {
    if (const auto good = check_output(*options_.record); !good) return good;
    if (const auto started = recorder_.start(*options_.record, 0); !started) return started;
  }
  auto query = open_query(options_, osc_port, session_.rack());
  if (!query) return fail(query);
  query_ = std::move(*query);
  if (options_.scene_to) {
    auto remote = open_remote_strikes(*options_.scene_to, session_.rack(), *driver_);
    if (!remote) return fail(ErrorKind::usage, remote.error().message);
    session_.scene().send_to(std::move(*remote));
  }
  if (const auto loaded = load(); !loaded) return loaded;
  if (!options_.capture) return {};
  const auto target = output_target(*options_.capture);
  return target ? capture_.start(*target) : fail(target);
}

// Without objects of another origin, the map's are loaded, if it says from where.
Result<void> Daemon::load_notes() {
  const std::optional<session::NoteMap>& map = notes_.map();
  const bool has_others = options_.scene || options_.state || !options_.objects.empty();
  if (!map || map->banks.empty() || has_others) return {};
  for (const session::NoteMap::Entry& entry : map->notes) {
    if (session_.rack().find({.name = entry.object})) continue;
    const auto bank = options_.notes->parent_path() / map->banks / entry.bank_file();
    if (const auto loaded = session_.rack().load(entry.object, bank); !loaded) return fail(loaded);
  }
  return {};
}

Result<void> Daemon::load() {
  // A second of silence before the scene starts: the driver may take that long.
  const auto start = static_cast<synth::Frame>(driver_->sample_rate_hz());
  for (const auto& [name, bank] : options_.objects) {
    if (const auto loaded = session_.rack().load(name, bank); !loaded) return fail(loaded);
  }
  if (const auto loaded = load_notes(); !loaded) return loaded;
  if (options_.scene) {
    if (const auto loaded = session_.scene().load(*options_.scene, start); !loaded) return fail(loaded);
  }
  if (const auto connected = connect_inputs(); !connected) return connected;
  const auto restored = restore(state_, session_, start);
  if (!restored) return fail(options_.state->string(), restored);
  tuner_.catch_up();
  return {};
}

Result<void> Daemon::connect_inputs() {
  // If no force is named, a sample of 1 is about the object's own weight.
  constexpr double kDefaultAcceleration_m_s2 = 10;
  for (std::size_t i = 0; i < options_.inputs.size(); ++i) {
    const DaemonOptions::Input& input = options_.inputs[i];
    const auto object = session_.rack().find({.name = input.object});
    if (!object) return fail("--input", object);
    const session::NoteTable::Strike chosen = session::best_strike(**object);
    const Vec3 force_n = (kDefaultAcceleration_m_s2 / session::kDefaultVelocity_m_s) * chosen.impulse_ns;
    const auto connected = session_.rack().excite(i, {.name = input.object}, input.point_m.value_or(chosen.point_m),
                                                  input.force_n.value_or(force_n));
    if (!connected) return fail("--input", connected);
  }
  return {};
}

Result<void> Daemon::play(wire::OscSocket socket) {
  session::Rack& rack = session_.rack();
  const std::uint16_t port = socket.port();
  const auto started = driver_->start({.mixer = rack.mixer(),
                                       .change_sample_rate = [this](double rate) { session_.change_sample_rate(rate); },
                                       .prepare_offline =
                                           [this](synth::Frame frame) {
                                             session_.scene().advance_to(frame, std::nullopt);
                                             wait_for_capture(session_.rack().mixer());
                                           },
                                       .buses = [&rack] { return rack.ports(); },
                                       .inputs = [&rack] { return rack.inputs(); },
                                       .notes = [this] { return notes_.table(); },
                                       .notes_played = rack.observers().notes_played()});
  if (!started) return started;
  service_ = std::make_unique<Service>(*this, std::move(socket));
  log_info(formatted("ready: OSC on {}:{}, {} objects, {} Hz, blocks of {}, {} kernel", options_.address, port,
                     rack.names()->size(), fixed(driver_->sample_rate_hz(), 0), driver_->block_frames(),
                     synth::kernel_target()));
  if (options_.notes || options_.connect || options_.keyboard) {
    if (const std::string keys = session::key_list(notes_.map(), rack.objects()); !keys.empty()) log_info(keys);
  }
  return {};
}

Result<void> Daemon::finish() {
  log_info("stopping");
  session_.scene().give_up();
  service_.reset();
  driver_.reset();
  return write_results();
}

Result<void> Daemon::write_results() {
  const auto recorded = write_recording();
  if (capture_.is_open()) {
    if (const auto frames = capture_.stop(); !frames && recorded) return fail(frames);
  }
  return recorded;
}

Result<void> Daemon::write_recording() {
  if (!recorder_.records()) return {};
  const synth::Frame end = session_.rack().mixer().counters().frames;
  const auto written = recorder_.stop(end);
  if (written) return {};
  std::error_code error;
  const auto spare = std::filesystem::temp_directory_path(error) / formatted("ringdown-recording-{}.osc", ::getpid());
  const bool saved = !error && recorder_.stop(end, spare);
  return fail(written.error().kind, written.error().message + (saved ? "; the recording is in " + spare.string()
                                                                     : "; the recording is lost"));
}

}  // namespace ringdown::server
