// ringdown_soak: a real jackd and a real ringdownd under random use; the JACK server is killed now and then, and
// another comes. Prints what it found, and exits with 1 when a sample was not finite, a block of the daemon's own came
// late, memory grew, descriptors were left open, a server was not met again within a second, or the daemon fell silent;
// with 77 where there is no jackd.
#include "tests/soak/actions.h"
#include "tests/soak/ear.h"
#include "tests/soak/health.h"
#include "tests/support/pauses.h"
#include "tests/support/temporary_folder.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <thread>
#include <utility>

namespace {

using namespace ringdown::test;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using ringdown::protocol::StatusReply;

struct Options {
  double seconds = 8 * 3600;
  double actions_per_second = 500;
  std::uint32_t seed = 1;
  bool without_jack = false;
  bool lenient = false, untimed = false;
};

struct Format {
  int rate, period, signal;
};
constexpr std::array<Format, 4> kServers = {
    {{44100, 512, SIGKILL}, {96000, 1024, SIGTERM}, {48000, 256, SIGKILL}, {44100, 256, SIGKILL}}};
constexpr double kBack_s = 1;  // within which the daemon plays at a new server

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

class Soak {
 public:
  explicit Soak(const Options& options);

  // Prints why not, and returns the exit code that says so.
  [[nodiscard]] int starts();
  void run();
  [[nodiscard]] bool report();

 private:
  Process::Environment environment();
  std::vector<std::string> arguments() const;
  [[nodiscard]] std::optional<StatusReply> catch_up();
  [[nodiscard]] std::optional<StatusReply> rest();
  [[nodiscard]] bool listen();
  void meet_another_server();
  void measure();
  void blame_xruns();
  void show_progress();
  [[nodiscard]] double passed_s() const { return seconds_since(start_); }

  Options options_;
  TemporaryFolder folder_;
  std::optional<JackServer> server_;
  HeapMeter heap_{folder_ / "heap", RINGDOWN_HEAP_METER_LIBRARY};
  std::optional<Daemon> daemon_;
  Heard heard_;
  std::optional<Ear> ear_;
  Actions actions_;
  Growth growth_;
  Pauses pauses_;
  std::uint64_t pauses_before_ = 0, pauses_last_ = 0;  // at the end of the last round but one, and of the last
  std::int32_t own_xruns_ = 0, unexcused_xruns_ = 0;
  double held_kb_ = 0;                 // at the last rest
  std::optional<StatusReply> status_;  // the last; none when the daemon has fallen silent
  std::size_t min_ = 0, max_ = 0;      // descriptors at rest
  std::size_t killed_ = 0, met_ = 0;   // servers
  double slowest_s_ = 0;               // to be met again
  double shown_s_ = 0;
  Clock::time_point start_ = Clock::now();
};

Soak::Soak(const Options& options) : options_(options), actions_(folder_.path(), options.seed) {
  if (!options_.without_jack) server_.emplace(48000, 256, JackServer::Mode::realtime);
}

Process::Environment Soak::environment() {
  Process::Environment environment = server_ ? server_->environment() : Process::Environment{};
  if (!options_.lenient) environment.merge(heap_.environment());
  return environment;
}

std::vector<std::string> Soak::arguments() const {
  std::vector<std::string> arguments = {"--settings", "none", "--root", folder_.path().string()};
  if (!server_) arguments.insert(arguments.end(), {"--driver", "null"});
  return arguments;
}

int Soak::starts() {
  if (server_ && (!installed("jackd") || !server_->runs())) {
    std::fprintf(stderr, "no JACK server can be started here\n");
    return 77;
  }
  daemon_.emplace(arguments(), environment());
  status_ = daemon_->ready() ? catch_up() : std::nullopt;
  if (status_ && (!server_ || listen())) return 0;
  std::fprintf(stderr, "the daemon does not start:\n%s", daemon_->process().output().c_str());
  return 1;
}

// Takes in all that the daemon has to say until it has done what was asked of it before.
std::optional<StatusReply> Soak::catch_up() {
  daemon_->send({"/sync", {1}});
  daemon_->send({"/status", {}});
  std::optional<StatusReply> status;
  for (bool synced = false; !synced || !status;) {
    const auto reply = daemon_->reply();
    if (!reply) return std::nullopt;
    if (const auto* found = reply->get_if<StatusReply>()) status = *found;
    synced = synced || reply->holds<ringdown::protocol::Synced>();
  }
  return status;
}

// Everything freed and forgotten: what is held now was held a while ago too, or has leaked.
std::optional<StatusReply> Soak::rest() {
  Actions::free_everything(*daemon_);
  std::optional<StatusReply> status;
  static_cast<void>(becomes_true([&] {
    status = catch_up();
    return !status || (status->sounding_objects == 0 && status->objects == 0);
  }));
  std::this_thread::sleep_for(1200ms);  // bundles that were sent for later, and the worker's next rounds
  return status;
}

bool Soak::listen() {
  ear_.emplace(server_->name(), heard_);
  return becomes_true([&] { return ear_->connect(); });
}

void Soak::meet_another_server() {
  const Format& next = kServers[killed_++ % kServers.size()];
  ear_.reset();
  server_->stop(next.signal);
  for (int n = 0; n < 50; ++n) actions_.act(*daemon_);  // without a server
  server_->start(next.rate, next.period);
  if (!server_->runs()) return;
  const auto back = Clock::now();
  if (!listen()) return;
  slowest_s_ = std::max(slowest_s_, seconds_since(back));
  ++met_;
}

// An xrun of ours is excused if the machine stood still in the same round or the one before.
void Soak::blame_xruns() {
  if (!status_) return;
  const std::int32_t fresh = status_->own_xruns - own_xruns_;
  own_xruns_ = status_->own_xruns;
  const std::uint64_t pauses = pauses_.count();
  if (pauses == pauses_before_) unexcused_xruns_ += fresh;
  pauses_before_ = std::exchange(pauses_last_, pauses);
}

void Soak::measure() {
  status_ = rest();
  const std::size_t open = descriptors(daemon_->process().id());
  min_ = min_ == 0 ? open : std::min(min_, open);
  max_ = std::max(max_, open);
  held_kb_ = heap_.kilobytes();
  growth_.note(passed_s(), held_kb_);
}

void Soak::show_progress() {
  shown_s_ = passed_s();
  std::printf("after %.0f s: %.1f kB held at rest, %.1f MB resident, %zu descriptors, %zu servers, %llu not finite\n",
              shown_s_, held_kb_, resident_mb(daemon_->process().id()), max_, met_,
              static_cast<unsigned long long>(heard_.not_finite));
  std::fflush(stdout);
}

void Soak::run() {
  const double measure_every_s = std::clamp(options_.seconds / 15, 2.0, 60.0);
  const double server_every_s = std::clamp(options_.seconds / 6, 4.0, 600.0);
  start_ = Clock::now();
  double measured_s = 0, server_s = 0;
  while (status_ && passed_s() < options_.seconds) {
    const auto round_end = Clock::now() + 200ms;
    for (int n = 0; n < options_.actions_per_second / 5; ++n) actions_.act(*daemon_);
    std::this_thread::sleep_until(round_end);
    status_ = catch_up();
    blame_xruns();
    if (server_ && passed_s() > server_s + server_every_s) {
      meet_another_server();
      server_s = passed_s();
    }
    if (status_ && passed_s() > measured_s + measure_every_s) {
      measure();
      measured_s = passed_s();
      if (measured_s > shown_s_ + options_.seconds / 40) show_progress();
    }
  }
}

bool line(const char* what, double figure, const char* unit, bool good = true) {
  std::printf("%-38s %12.6g %-6s %s\n", what, figure, unit, good ? "" : "MISSED");
  return good;
}

bool Soak::report() {
  const double resident = resident_mb(daemon_->process().id()), lasted_s = passed_s();
  daemon_->process().send_signal(SIGTERM);
  const bool ended = daemon_->process().wait() == 0;
  std::printf("%.0f s, %llu actions, seed %u\n", lasted_s, static_cast<unsigned long long>(actions_.count()),
              options_.seed);
  bool good = line("answered to the end", status_.has_value(), "", status_.has_value());
  good &= line("ended cleanly", ended, "", ended);
  if (server_) {
    good &= line("samples listened to", static_cast<double>(heard_.samples), "", heard_.samples > 0);
    good &= line("of these not silent", static_cast<double>(heard_.loud), "", heard_.loud > 0);
    good &= line("samples not finite", static_cast<double>(heard_.not_finite), "", heard_.not_finite == 0);
    line("JACK servers killed", static_cast<double>(killed_), "");
    good &= line("of these not met again", static_cast<double>(killed_ - met_), "", killed_ == met_);
    good &= line("slowest to be met again", slowest_s_, "s", slowest_s_ <= kBack_s || options_.untimed);
  }
  if (!options_.lenient) {
    good &= line("memory growth, at rest", growth_.mb_per_hour(), "MB/h", growth_.mb_per_hour() < 1);
    line("held at the last rest", held_kb_, "kB");
  }
  line("resident in the end", resident, "MB");
  good &= line("descriptors, max less min", static_cast<double>(max_ - min_), "", max_ == min_);
  if (status_) {
    line("xruns of the server", status_->xruns, "");
    line("of these our own", own_xruns_, "");
    good &= line("and not while the machine stood still", unexcused_xruns_, "",
                 unexcused_xruns_ == 0 || options_.untimed || !pauses_.works());
    line("times the machine stood still", static_cast<double>(pauses_.count()), "");
    line("events dropped", status_->dropped_events, "");
    line("mean load", 100 * status_->load_mean, "%");
  }
  if (!good) std::fprintf(stderr, "%s\n", daemon_->process().output().c_str());
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("A daemon under random use.", "ringdown_soak");
  app.add_option("--seconds", options.seconds, "How long")->capture_default_str();
  app.add_option("--actions", options.actions_per_second, "Messages a second")->capture_default_str();
  app.add_option("--seed", options.seed, "Of the random actions")->capture_default_str();
  app.add_flag("--without-jack", options.without_jack, "The null driver; nothing is listened to");
  app.add_flag("--untimed", options.untimed,
               "Own xruns and slow meetings are told, not judged: for machines that do something else, too");
  app.add_flag("--lenient", options.lenient, "Neither is growth, which is not even measured: for sanitizers");
  CLI11_PARSE(app, argc, argv);
  options.untimed = options.untimed || options.lenient;
  Soak soak(options);
  if (const int code = soak.starts(); code != 0) return code;
  soak.run();
  return soak.report() ? 0 : 1;
}
