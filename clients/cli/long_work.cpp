#include "clients/cli/long_work.h"

#include "engine/base/process/sandbox.h"
#include "engine/base/process/signals.h"

#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <thread>
#include <unistd.h>

namespace ringdown::cli {
namespace {

using protocol::ExitCode;

constexpr std::chrono::milliseconds kPoll{50};

// True once a thread that does not block the signals has taken one: OpenBLAS starts its threads before main(). The
// kernel prefers such threads to a main thread that is between two calls of sigtimedwait().
std::atomic<bool> taken_elsewhere = false;

bool signal_arrived(const sigset_t& signals) {
  const timespec poll = {0, std::chrono::nanoseconds(kPoll).count()};
  return sigtimedwait(&signals, nullptr, &poll) > 0 || taken_elsewhere.exchange(false);
}

}  // namespace

void ProgressLine::show(std::string_view stage, double fraction) {
  const auto now = std::chrono::steady_clock::now();
  if (style_ == Style::none || (stage == stage_ && now - shown_ < std::chrono::milliseconds(100))) return;
  stage_ = stage;
  shown_ = now;
  if (style_ == Style::lines) {
    std::printf("%.3f %s\n", fraction, stage_.c_str());
    std::fflush(stdout);
    return;
  }
  constexpr int kWidth = 30;
  std::string bar;
  if (fraction > 0) {
    const int filled = static_cast<int>(std::lround(kWidth * std::min(1.0, fraction)));
    bar = " [" + std::string(filled, '=') + std::string(kWidth - filled, ' ') + "]";
  }
  std::fprintf(stderr, "\r\x1b[K%s: %s%s", title_.c_str(), stage_.c_str(), bar.c_str());
  std::fflush(stderr);
}

void ProgressLine::clear() {
  if (style_ != Style::bar || stage_.empty()) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  stage_.clear();
}

protocol::ExitCode run_cancellable(const std::function<protocol::ExitCode(std::stop_token)>& work,
                                   std::chrono::milliseconds patience) {
  const sigset_t signals = ending_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  for (int signal = 1; signal < NSIG; ++signal) {
    if (sigismember(&signals, signal) == 1) std::signal(signal, [](int) { taken_elsewhere = true; });
  }

  std::atomic<bool> done = false;
  ExitCode exit_code = ExitCode::ok;
  std::jthread worker([&](std::stop_token stop) {
    exit_code = static_cast<ExitCode>(protocol::exit_status([&] { return work(stop); }));
    done = true;
  });
  bool cancelled = false;
  for (auto polls = patience / kPoll; !done;) {
    if (signal_arrived(signals)) {
      cancelled = true;
      worker.request_stop();
    }
    if (cancelled && !done && --polls == 0) {
      static constexpr char kMessage[] = "\ncancelled; no file was left half-written\n";
      [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
      ::_exit(static_cast<int>(ExitCode::cancelled));
    }
  }
  worker.join();
  return exit_code;
}

void warn_of_open_sandbox() {
  const SandboxState state = sandbox_of_kernel();
  if (!state.files) {
    std::fprintf(stderr,
                 "warning: this kernel has no Landlock, so the process that reads a mesh file could read other "
                 "files, too; use files that you trust\n");
  }
  if (!state.calls) {
    std::fprintf(stderr,
                 "warning: this kernel has no seccomp filters, so a mesh file could make the process that reads "
                 "it run programs and write files; use files that you trust\n");
  }
}

ExitCode complain_unwritten(const Error& error, const std::filesystem::path& output) {
  if (error.kind != ErrorKind::cancelled) return protocol::complain(error);
  return protocol::complain({error.kind, "cancelled; " + output.string() + " was not written"});
}

}  // namespace ringdown::cli
