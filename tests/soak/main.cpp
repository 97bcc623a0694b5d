// ringdown_soak: a real jackd and a real ringdownd under random use. Prints what it found, and exits with 1 when a
// sample was not finite, memory grew, descriptors were left open or the daemon fell silent; with 77 where there is no
// jackd.
#include "tests/soak/actions.h"
#include "tests/soak/ear.h"
#include "tests/soak/health.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <optional>
#include <thread>

namespace {

using namespace ringdown::test;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct Options {
  double seconds = 8 * 3600;
  double actions_per_second = 500;
  std::uint32_t seed = 1;
  bool without_jack = false;
  bool any_growth = false;
};

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Takes in all that the daemon has to say until it has done what was asked of it before.
std::optional<ringdown::protocol::StatusReply> catch_up(Daemon& daemon) {
  daemon.send({"/sync", {1}});
  daemon.send({"/status", {}});
  std::optional<ringdown::protocol::StatusReply> status;
  for (bool synced = false; !synced || !status;) {
    const auto reply = daemon.reply(20s);
    if (!reply) return std::nullopt;
    if (const auto* found = std::get_if<ringdown::protocol::StatusReply>(&*reply)) status = *found;
    synced = synced || std::holds_alternative<ringdown::protocol::Synced>(*reply);
  }
  return status;
}

// Everything freed and forgotten: what is held now was held a while ago too, or has leaked.
std::optional<ringdown::protocol::StatusReply> rest(Daemon& daemon, Actions& actions) {
  actions.free_everything(daemon);
  std::optional<ringdown::protocol::StatusReply> status;
  const auto limit = Clock::now() + 20s;
  do {
    status = catch_up(daemon);
    std::this_thread::sleep_for(50ms);
  } while (status && (status->sounding_objects > 0 || status->objects > 0) && Clock::now() < limit);
  std::this_thread::sleep_for(1200ms);  // bundles that were sent for later, and the worker's next rounds
  return status;
}

bool report(const char* what, double figure, const char* unit, bool good) {
  std::printf("%-34s %12.6g %-6s %s\n", what, figure, unit, good ? "" : "MISSED");
  return good;
}

int soak(const Options& options) {
  const ScratchFolder folder;
  std::optional<JackServer> server;
  if (!options.without_jack && !server.emplace().runs()) {
    std::fprintf(stderr, "no JACK server can be started here\n");
    return 77;
  }
  HeapMeter heap(folder / "heap", RINGDOWN_HEAP_METER_LIBRARY);
  Process::Environment environment = server ? server->environment() : Process::Environment{};
  if (!options.any_growth) environment.merge(heap.environment());
  std::vector<std::string> arguments = {"--root", folder.path().string()};
  if (!server) arguments.insert(arguments.end(), {"--driver", "null"});
  Daemon daemon(arguments, environment);
  Heard heard;
  std::optional<Ear> ear;
  if (server) ear.emplace(server->name(), heard);
  if (!daemon.ready() || (ear && !ear->connect())) {
    std::fprintf(stderr, "the daemon does not start:\n%s", daemon.process().output().c_str());
    return 1;
  }
  Actions actions(folder.path(), options.seed);
  Growth growth;
  std::optional<ringdown::protocol::StatusReply> status = catch_up(daemon);
  std::size_t fewest = descriptors(daemon.process().id()), most = fewest;
  const auto start = Clock::now();
  const double resting_every_s = std::clamp(options.seconds / 15, 2.0, 60.0);
  double rested_s = 0, shown_s = 0;
  while (status && seconds_since(start) < options.seconds) {
    const auto round_end = Clock::now() + 200ms;
    for (int n = 0; n < options.actions_per_second / 5; ++n) actions.act(daemon);
    std::this_thread::sleep_until(round_end);
    status = catch_up(daemon);
    const std::size_t open = descriptors(daemon.process().id());
    fewest = std::min(fewest, open);
    most = std::max(most, open);
    if (status && seconds_since(start) > rested_s + resting_every_s) {
      status = rest(daemon, actions);
      rested_s = seconds_since(start);
      growth.note(rested_s, heap.kilobytes());
    }
    if (seconds_since(start) > shown_s + 600) {
      shown_s = seconds_since(start);
      std::printf("after %.0f s: %.1f kB held at rest, %.1f MB resident, %zu descriptors, %llu not finite\n", shown_s,
                  heap.kilobytes(), resident_mb(daemon.process().id()), open,
                  static_cast<unsigned long long>(heard.not_finite));
      std::fflush(stdout);
    }
  }
  const double held_kb = heap.kilobytes(), resident = resident_mb(daemon.process().id());
  const double lasted_s = seconds_since(start);
  daemon.process().send_signal(SIGTERM);
  const bool ended = daemon.process().wait(20s) == 0;
  if (!ended || !status) std::fprintf(stderr, "%s\n", daemon.process().output().c_str());

  std::printf("%.0f s, %llu actions, seed %u\n", lasted_s, static_cast<unsigned long long>(actions.count()),
              options.seed);
  bool good = report("answered to the end", status.has_value(), "", status.has_value());
  good &= report("ended cleanly", ended, "", ended);
  if (ear) {
    good &= report("samples listened to", static_cast<double>(heard.samples), "", heard.samples > 0);
    good &= report("of these not silent", static_cast<double>(heard.loud), "", heard.loud > 0);
    good &= report("samples not finite", static_cast<double>(heard.not_finite), "", heard.not_finite == 0);
  }
  if (!options.any_growth) {
    good &= report("memory growth, at rest", growth.mb_per_hour(), "MB/h", growth.mb_per_hour() < 1);
    report("held in the end", held_kb, "kB", true);
  }
  report("resident in the end", resident, "MB", true);
  good &= report("descriptors, most less fewest", static_cast<double>(most - fewest), "", most == fewest);
  if (status) {
    report("xruns of the server", status->xruns, "", true);
    report("events dropped", status->dropped_events, "", true);
    report("mean load", 100 * status->load_mean, "%", true);
  }
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("A daemon under random use.", "ringdown_soak");
  app.add_option("--seconds", options.seconds, "How long")->capture_default_str();
  app.add_option("--actions", options.actions_per_second, "Messages a second")->capture_default_str();
  app.add_option("--seed", options.seed, "Of the random actions")->capture_default_str();
  app.add_flag("--without-jack", options.without_jack, "The null driver; nothing is listened to");
  app.add_flag("--any-growth", options.any_growth, "Memory may grow: sanitizers keep what was freed");
  CLI11_PARSE(app, argc, argv);
  return soak(options);
}
