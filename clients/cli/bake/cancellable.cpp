#include "clients/cli/bake/cancellable.h"

#include <atomic>
#include <csignal>
#include <ctime>
#include <thread>
#include <unistd.h>

namespace ringdown::cli {
namespace {

using protocol::ExitCode;

constexpr std::chrono::milliseconds kPoll{50};

bool signal_arrived(const sigset_t& signals) {
  const timespec poll = {0, std::chrono::nanoseconds(kPoll).count()};
  return sigtimedwait(&signals, nullptr, &poll) > 0;
}

}  // namespace

protocol::ExitCode run_cancellable(const std::function<protocol::ExitCode(std::stop_token)>& work,
                                   std::chrono::milliseconds patience) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);

  std::atomic<bool> done = false;
  ExitCode exit_code = ExitCode::ok;
  std::jthread worker([&](std::stop_token stop) {
    exit_code = work(stop);
    done = true;
  });
  bool cancelled = false;
  for (auto polls = patience / kPoll; !done;) {
    if (signal_arrived(signals)) {
      cancelled = true;
      worker.request_stop();
    }
    if (cancelled && !done && --polls == 0) {
      static constexpr char kMessage[] = "\ncancelled; no bank was left half-written\n";
      [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
      ::_exit(static_cast<int>(ExitCode::cancelled));
    }
  }
  worker.join();
  return exit_code;
}

}  // namespace ringdown::cli
