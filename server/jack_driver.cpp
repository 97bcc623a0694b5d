// The JACK driver: a thread that manages a JackClient, and continues without one while there is no server.
//
// While the server is away the null driver renders, so that time passes: tails decay, the scene plays, timed events
// happen on time, queues are emptied. When a server answers, the mixer is retuned to its rate between two blocks.
//
// A server that still exists but no longer calls is left and joined again in the same way: PipeWire 0.3.65 was seen to
// forget a client when it changed its quantum on a busy machine. While it does not call a new client either, the driver
// retries at intervals that grow to half a minute.
#include "server/call_watch.h"
#include "server/driver.h"
#include "server/jack_client.h"
#include "server/load_meter.h"
#include "server/log.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <mutex>
#include <semaphore>
#include <system_error>
#include <thread>
#include <utility>

namespace ringdown::server {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPatience = 1s;        // a server that has not called for this long is left
constexpr double kPatientBlocks = 4;  // or for this many blocks, if that is longer than kPatience
constexpr auto kMaxPause = 30s;       // pause between two tries with a server that does not call

constexpr const char* kNoDevice = "Midi Through";  // ALSA's, which JACK shows as a device

int lower(unsigned char letter) { return std::tolower(letter); }

// Returns whether a name has a part, in upper or lower case.
bool contains(const std::string& name, const std::string& part) {
  return !std::ranges::search(name, part, {}, lower, lower).empty() || part.empty();
}

// Wakes the driver's thread. JACK's threads share ownership, because they may use it after the driver has gone.
using Bell = std::counting_semaphore<>;

class JackDriver final : public Driver {
 public:
  JackDriver(JackOptions options, std::shared_ptr<Bell> bell, std::shared_ptr<LoadMeter> meter,
             std::shared_ptr<session::MidiPlayer> midi, std::unique_ptr<JackClient> client)
      : options_(std::move(options)),
        bell_(std::move(bell)),
        meter_(std::move(meter)),
        midi_(std::move(midi)),
        client_(std::move(client)),
        connect_(options_.connect),
        keyboard_(options_.keyboard) {
    note_format();
  }

  ~JackDriver() override {
    thread_.request_stop();
    bell_->release();
    if (thread_.joinable()) thread_.join();
    if (client_) close(std::move(client_));
    wait_until_closed(2s);
  }

  [[nodiscard]] double sample_rate_hz() const override { return sample_rate_hz_; }
  [[nodiscard]] std::size_t block_frames() const override {
    const std::scoped_lock lock(mutex_);
    return client_ ? client_->block_frames() : block_frames_;
  }
  [[nodiscard]] Load load() const override { return meter_->read(); }

  Result<void> start(Program program) override {
    program_ = std::make_unique<Program>(std::move(program));
    if (!client_) {
      go_on_alone();
    } else if (const auto started = client_->start(*program_); !started) {
      return started;
    }
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
    return {};
  }

  [[nodiscard]] synth::Frame now() const override {
    const std::scoped_lock lock(mutex_);
    if (client_) return client_->now();
    return stand_in_ ? stand_in_->now() : program_->mixer.counters().frames.load();
  }

  void program_changed() override { bell_->release(); }

  [[nodiscard]] bool freewheels() const override {
    const std::scoped_lock lock(mutex_);
    return client_ && client_->freewheels();
  }

  [[nodiscard]] int control_priority() const override {
    const std::scoped_lock lock(mutex_);
    return client_ ? std::max(client_->priority() - 1, 0) : 0;
  }

 private:
  void run(const std::stop_token& stop) {
    if (client_) look_after_client();
    while (!stop.stop_requested()) {
      static_cast<void>(bell_->try_acquire_for(client_ ? 100ms : 150ms));
      while (bell_->try_acquire()) continue;
      if (!client_) {
        meet_server();
      } else if (client_->lost()) {
        log_warning("the JACK server has stopped; the daemon plays on in silence until a server returns");
        leave_server();
      } else {
        leave_if_silent();
      }
      if (client_) look_after_client();
    }
  }

  void note_format() {
    sample_rate_hz_ = client_ ? client_->sample_rate_hz() : options_.sample_rate_hz;
    block_frames_ = client_ ? client_->block_frames() : options_.block_frames;
  }

  void go_on_alone() {
    auto stand_in = open_null(sample_rate_hz_, block_frames_);
    if (const auto started = (*stand_in)->start(*program_); !started) {
      log_warning("the daemon stands still until a JACK server answers: " + started.error().message);
      return;
    }
    const std::scoped_lock lock(mutex_);
    stand_in_ = std::move(*stand_in);
  }

  // Leaves a server that has stopped calling. A server that waits for a slow client in freewheel, or is inside our
  // callback, has not stopped.
  void leave_if_silent() {
    const std::uint64_t calls = client_->calls();
    const auto silence = watch_.look(calls, client_->freewheels() || calls % 2 == 1, Clock::now());
    const double silence_s = std::chrono::duration<double>(silence).count();
    if (watch_.was_called() && std::exchange(pause_, {}) != Clock::duration::zero()) log_info("JACK calls again");
    const double block_s = static_cast<double>(client_->block_frames()) / sample_rate_hz_;
    if (silence < kPatience || silence_s < kPatientBlocks * block_s) return;
    if (pause_ == Clock::duration::zero()) {
      log_warning(
          "JACK has not called for " + fixed(silence_s, 1) +
          " s, although its server runs; the daemon leaves it and connects again, and plays on in silence until then");
    }
    leave_server();
    meter_->note_stall(silence_s);
    if (!watch_.was_called()) pause_ = std::clamp<Clock::duration>(2 * pause_, kPatience, kMaxPause);
    meet_at_ = Clock::now() + pause_;
  }

  void leave_server() {
    client_->stop();
    missing_.insert(connections_.begin(), connections_.end());
    connections_.clear();
    std::unique_ptr<JackClient> old;
    {
      const std::scoped_lock lock(mutex_);
      old = std::move(client_);
    }
    close(std::move(old));
    go_on_alone();
  }

  // libjack holds its own lock while it closes a client, so no client can be opened before that is done.
  void meet_server() {
    if (!*closed_ || Clock::now() < meet_at_) return;
    auto client = JackClient::open(options_.client_name, meter_, midi_, [bell = bell_] { bell->release(); });
    if (!client) return;
    std::unique_ptr<Driver> stand_in;
    {
      const std::scoped_lock lock(mutex_);
      stand_in = std::move(stand_in_);
    }
    stand_in.reset();
    if (client->sample_rate_hz() != sample_rate_hz_) program_->change_sample_rate(client->sample_rate_hz());
    const auto started = client->start(*program_);
    {
      const std::scoped_lock lock(mutex_);
      client_ = std::move(client);
      note_format();
    }
    watch_ = {};
    if (!started) return leave_server();
    if (pause_ != Clock::duration::zero()) return;
    log_info(formatted("connected to a JACK server: {} Hz, blocks of {}", fixed(sample_rate_hz_, 0), block_frames_));
  }

  void look_after_client() {
    if (const double rate = client_->sample_rate_hz(); rate != sample_rate_hz_) change_rate(rate);
    client_->show_buses(program_->buses());
    client_->show_inputs(program_->inputs());
    client_->set_notes(program_->notes());
    if (std::exchange(connect_, false)) connect_to_speakers();
    if (keyboard_) find_keyboard();
    for (const JackConnection& missing : missing_) client_->connect(missing);
    client_->note_listeners();
    remember_connections();
    report_losses();
  }

  void connect_to_speakers() {
    const auto speakers = client_->others(JackClient::Others::speakers);
    constexpr std::array kMix = {"out_left", "out_right"};
    for (std::size_t i = 0; i < std::min(kMix.size(), speakers.size()); ++i) client_->connect({kMix[i], speakers[i]});
  }

  // A keyboard that is plugged in later is found then. It is connected once: users may disconnect it. A port that is
  // named may be a program's.
  void find_keyboard() {
    const bool any = keyboard_->empty();
    const auto sources = client_->others(any ? JackClient::Others::midi_devices : JackClient::Others::midi_sources);
    const auto found = std::ranges::find_if(sources, [&](const std::string& source) {
      return any ? !contains(source, kNoDevice) : contains(source, *keyboard_);
    });
    if (found != sources.end()) {
      if (!client_->connect({"midi_in", *found})) return;  // its program has not begun: soon again
      log_info("plays what comes from " + *found);
      keyboard_.reset();
    } else if (!std::exchange(waits_for_keyboard_, true)) {
      log_info(any ? "no MIDI keyboard yet; the first one that appears is connected"
                   : "no MIDI port with \"" + *keyboard_ + "\" in its name yet; it is connected when it appears");
    }
  }

  // PipeWire may change its rate under a client.
  void change_rate(double rate) {
    client_->stop();
    program_->change_sample_rate(rate);
    sample_rate_hz_ = rate;
    client_->go_on();
    log_info("JACK's sample rate is now " + fixed(rate, 0) + " Hz");
  }

  // A server that ends stops its audio, disconnects its ports, and notifies us last, which may take long on a busy
  // machine. A lost connection is therefore forgotten only once the server has called for another 0.3 s of sound. A
  // requested connection counts as missing until it is seen, because the server may end in between.
  void remember_connections() {
    const auto present = client_->connections();
    if (client_->lost()) return;
    const synth::Frame rendered = program_->mixer.counters().frames.load();
    if (present != last_seen_) changed_at_ = rendered;
    std::erase_if(missing_, [&present](const JackConnection& missing) { return present.contains(missing); });
    if (static_cast<double>(rendered - changed_at_) > 0.3 * sample_rate_hz_) connections_.clear();
    connections_.insert(present.begin(), present.end());
    last_seen_ = present;
  }

  void report_losses() {
    if (const std::uint64_t dropped = midi_->dropped(); dropped != dropped_notes_) {
      log_warning(formatted("{} notes lost: more events at once than the mixer takes", dropped - dropped_notes_));
      dropped_notes_ = dropped;
    }
    const Load load = meter_->read();
    if (load.xruns > load.own_xruns && !std::exchange(reported_foreign_, true)) {
      log_info(
          "JACK reports an xrun that Ringdown did not cause: another client or the server was late; /status counts "
          "such xruns");
    }
    const auto late = load.own_xruns - reported_own_;
    if (late == 0 || Clock::now() - reported_at_ < 10s) return;
    log_warning(
        formatted("{} caused by Ringdown, {} s of sound skipped so far; the callback's load is {}, its 99th percentile "
                  "{}, its peak {}",
                  late == 1 ? "an xrun" : formatted("{} xruns", late), fixed(load.skipped_s, 2), fixed(load.mean, 2),
                  fixed(load.p99, 2), fixed(load.peak, 2)));
    reported_own_ = load.own_xruns;
    reported_at_ = Clock::now();
  }

  // Closes the client on a detached thread, because jack_client_close() may hang; or on this thread, if the system
  // gives us no more threads.
  void close(std::unique_ptr<JackClient> client) {
    closed_ = std::make_shared<std::atomic<bool>>(false);
    const auto close_now = [client = client.release(), closed = closed_, bell = bell_] {
      delete client;
      *closed = true;
      bell->release();
    };
    try {
      std::thread(close_now).detach();
    } catch (const std::system_error&) {
      close_now();
    }
    wait_until_closed(100ms);
  }

  void wait_until_closed(Clock::duration limit) const {
    const auto end = Clock::now() + limit;
    while (!*closed_ && Clock::now() < end) std::this_thread::sleep_for(1ms);
  }

  const JackOptions options_;
  const std::shared_ptr<Bell> bell_;
  const std::shared_ptr<LoadMeter> meter_;
  const std::shared_ptr<session::MidiPlayer> midi_;
  std::unique_ptr<Program> program_;
  std::atomic<double> sample_rate_hz_ = 0;

  // The driver's thread changes these, with the mutex where other threads read them.
  mutable std::mutex mutex_;  // guards client_ and stand_in_: at most one of them renders
  std::unique_ptr<JackClient> client_;
  std::unique_ptr<Driver> stand_in_;
  std::size_t block_frames_ = 0;
  std::set<JackConnection> connections_, last_seen_;  // connections to restore; connections of a moment ago
  std::set<JackConnection> missing_;                  // connections of the former server that are not restored yet
  synth::Frame changed_at_ = 0;                       // the mixer's frame when last_seen_ was another
  CallWatch watch_;                                   // of client_
  Clock::duration pause_{};                           // before the next try with a server that did not call at all
  Clock::time_point meet_at_{};                       // no client is opened before
  Clock::time_point reported_at_{};
  std::int32_t reported_own_ = 0;  // xruns
  bool reported_foreign_ = false;
  std::uint64_t dropped_notes_ = 0;
  bool connect_;
  std::optional<std::string> keyboard_;  // to be found
  bool waits_for_keyboard_ = false;
  std::shared_ptr<std::atomic<bool>> closed_ = std::make_shared<std::atomic<bool>>(true);
  std::jthread thread_;
};

}  // namespace

Result<std::unique_ptr<Driver>> open_jack(const JackOptions& options, std::shared_ptr<session::MidiPlayer> midi) {
  if (const std::size_t max = max_jack_name_length(); options.client_name.size() > max) {
    return fail(ErrorKind::usage, "--name: JACK takes names of at most {} bytes, not {}", max,
                options.client_name.size());
  }
  const auto bell = std::make_shared<Bell>(0);
  const auto meter = std::make_shared<LoadMeter>();
  auto client = JackClient::open(options.client_name, meter, midi, [bell] { bell->release(); });
  if (!client && !options.wait) {
    return fail(ErrorKind::no_sound_server,
                "no JACK server answers, or it has no free port; start one (jackd or PipeWire), wait for one with "
                "--wait, or run with --driver null or --driver wav");
  }
  if (!client) log_info("no JACK server answers yet; waiting for one");
  return std::make_unique<JackDriver>(options, bell, meter, std::move(midi), std::move(client));
}

}  // namespace ringdown::server
