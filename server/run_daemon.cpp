#include "server/run_daemon.h"

#include "server/daemon.h"
#include "server/service_notice.h"
#include "server/session/offline.h"

#include <spdlog/spdlog.h>

#include <chrono>
#include <csignal>
#include <optional>
#include <string>
#include <utility>

namespace ringdown::server {
namespace {

using namespace std::chrono_literals;
using protocol::complain;
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

// What a file that is rendered has no use for.
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

ExitCode render_to_file(const DaemonOptions& options) {
  if (const auto good = check_render(options); !good) return complain(good.error());
  const auto recording = session::render_offline({.scene = options.scene,
                                                  .objects = options.objects,
                                                  .seconds = options.seconds,
                                                  .sample_rate_hz = options.sample_rate_hz,
                                                  .block_frames = options.block_frames,
                                                  .mixer = options.mixer},
                                                 [](double) { return !signal_came(0ms); });
  if (!recording) return complain(recording.error());
  for (const std::string& warning : recording->warnings) spdlog::warn("{}", warning);
  if (const auto written = session::write_audio(*recording, options.output); !written) return complain(written.error());
  spdlog::info("wrote {}, {:.2f} s", options.output.string(),
               static_cast<double>(recording->left.size()) / recording->sample_rate_hz);
  return ExitCode::ok;
}

// Returns when a signal came, a client asked for it, or the time is over.
void wait_for_the_end(const Daemon& daemon, std::optional<double> seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds.value_or(1e9));
  ServiceNotice service;
  while (!daemon.quits() && std::chrono::steady_clock::now() < end) {
    service.turn(daemon.frames(), daemon.worker_rounds());
    if (signal_came(50ms)) break;
  }
  service.stopping();
}

}  // namespace

ExitCode run_daemon(const DaemonOptions& options) {
  const sigset_t signals = ending_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);  // libjack writes to servers that are gone
  if (options.driver == DaemonOptions::DriverKind::wav) return render_to_file(options);

  const auto daemon = Daemon::start(options);
  if (!daemon) return complain(daemon.error());
  wait_for_the_end(**daemon, options.seconds);
  const auto finished = (*daemon)->finish();
  return finished ? ExitCode::ok : complain(finished.error());
}

}  // namespace ringdown::server
