#include "server/program.h"

#include "engine/base/process/signals.h"
#include "engine/base/within_memory.h"
#include "packaging/manual/command_line.h"
#include "protocol/exit_codes.h"
#include "server/daemon.h"
#include "server/log.h"
#include "server/options.h"
#include "server/service_notice.h"
#include "server/session/offline.h"
#include "server/settings.h"

#include <chrono>
#include <csignal>
#include <cstring>
#include <optional>
#include <string>
#include <unistd.h>
#include <utility>

namespace ringdown::server {
namespace {

using namespace std::chrono_literals;
using protocol::ExitCode;

// Sections of the man page in addition to the options.
const std::vector<manual::Section> kSections = {
    {"FILES",
     {{"$XDG_CONFIG_HOME/ringdown/ringdownd.toml",
       "The settings, unless --settings names another file; ~/.config if XDG_CONFIG_HOME is not set. The file may have "
       "any option under its long name, such as rate = 44100, connect = true, object = [\"bell=bell.glb\"]; the "
       "command line takes precedence."}}},
    {"SIGNALS",
     {{"SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1, SIGUSR2, SIGXCPU",
       "End the daemon cleanly, with exit code 0; recordings and captures are written first. A signal other than "
       "SIGINT and SIGTERM that was ignored when the daemon started, as nohup does with SIGHUP, stays ignored."},
      {"SIGXFSZ", "Ignored: a file that reaches its size limit is treated like a full disk."}}},
    {"ENVIRONMENT",
     {{"JACK_DEFAULT_SERVER, JACK_NO_START_SERVER", "The JACK server to use, and whether to start one: see jackd(1)."},
      {"NOTIFY_SOCKET, WATCHDOG_USEC",
       "Set by systemd; the daemon reports that sound runs, and then that it still runs."}}},
    {"EXAMPLES",
     {{"ringdownd --object bell=bell.glb --connect", "Plays one object through the speakers."},
      {"ringdownd --scene demo.toml --driver wav -o demo.wav", "Renders a scene to a file at full speed."},
      {"systemctl --user enable --now ringdownd", "Runs the daemon as a service, from now on."}}},
    {"SEE ALSO",
     {{"ringdown(1), ringdown-bake(1), jackd(1)", "The clients, the program that makes banks, and the sound server."}}},
};

// Waits for one of ending_signals() and returns true if one has come. The signals are blocked in every thread; the main
// thread takes them.
bool signal_came(std::chrono::milliseconds wait) {
  static const sigset_t signals = ending_signals();
  const timespec time{.tv_sec = 0, .tv_nsec = std::chrono::nanoseconds(wait).count()};
  const int signal = sigtimedwait(&signals, nullptr, &time);
  if (signal > 0) log_info(formatted("SIG{} received", sigabbrev_np(signal)));
  return signal > 0;
}

// Refuses options that have no meaning when a file is rendered.
Result<void> check_render(const DaemonOptions& options) {
  for (const auto& [given, name] :
       {std::pair(options.record.has_value(), "--record"), std::pair(options.capture.has_value(), "--capture"),
        std::pair(options.state.has_value(), "--state"), std::pair(options.notes.has_value(), "--notes"),
        std::pair(options.scene_to.has_value(), "--scene-to")}) {
    if (given) {
      return fail(ErrorKind::usage, std::string(name) + ": the wav driver only renders; use --driver jack or null");
    }
  }
  return {};
}

ExitCode render_to_file(const DaemonOptions& options, Log& log) {
  if (const auto good = check_render(options); !good) return log.complain(good.error());
  const auto rendering = session::render_to_file({.scene = options.scene,
                                                  .objects = options.objects,
                                                  .seconds = options.seconds,
                                                  .sample_rate_hz = options.sample_rate_hz,
                                                  .fade_s = session::kFade_s,
                                                  .block_frames = options.block_frames,
                                                  .mixer = options.mixer},
                                                 options.output, [](double) { return !signal_came(0ms); });
  if (!rendering) return log.complain(rendering.error());
  for (const std::string& warning : rendering->warnings) log_warning(warning);
  log_info(formatted("wrote {}, {} s", options.output.string(), fixed(rendering->seconds, 2)));
  return ExitCode::ok;
}

// Returns when a signal has come, a client has sent /quit, or the time is over.
void wait_for_the_end(const Daemon& daemon, std::optional<double> seconds, Log& log) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds.value_or(1e9));
  ServiceNotice service;
  while (!daemon.quits() && std::chrono::steady_clock::now() < end) {
    service.turn(daemon.frames(), daemon.worker_rounds());
    log.report_dropped();
    if (signal_came(50ms)) break;
  }
  service.stopping();
}

// Runs until a signal, /quit or the end of --seconds. Blocks the ending signals for the whole process.
ExitCode run(const DaemonOptions& options, Log& log) {
  const sigset_t signals = ending_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);  // libjack writes to sockets of servers that have ended
  take_file_limit_as_error();
  if (options.driver == DaemonOptions::DriverKind::wav) return render_to_file(options, log);

  const auto daemon = Daemon::start(options);
  if (!daemon) return log.complain(daemon.error());
  wait_for_the_end(**daemon, options.seconds, log);
  const auto finished = (*daemon)->finish();
  return finished ? ExitCode::ok : log.complain(finished.error());
}

}  // namespace

int run_program(int argc, char** argv) {
  Log log(STDERR_FILENO);

  DaemonOptions options;
  std::optional<std::string> settings;
  manual::App app("Rings solid objects: a JACK client, struck by OSC messages.", "ringdownd");
  add_options(app, options);
  app.add_option("--settings", settings,
                 "TOML file of options by their long names; none: read no file (ringdown/ringdownd.toml in "
                 "$XDG_CONFIG_HOME, if there is one)")
      ->type_name("FILE")
      ->not_in_settings();
  if (const auto ended = manual::parse(app, argc, argv, kSections)) return static_cast<int>(*ended);
  if (const auto file = settings_file(settings)) {
    if (const auto read = read_settings(app, *file); !read) return static_cast<int>(log.complain(read.error()));
  }
  const auto code = within_memory("go on", [&]() -> Result<ExitCode> { return run(options, log); });
  return static_cast<int>(code ? *code : log.complain(code.error()));
}

}  // namespace ringdown::server
