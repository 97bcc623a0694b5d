#include "engine/base/process/signals.h"

#include <initializer_list>

namespace ringdown {
namespace {

bool has_default_action(int signal) {
  struct sigaction action {};
  return ::sigaction(signal, nullptr, &action) == 0 && (action.sa_flags & SA_SIGINFO) == 0 &&
         action.sa_handler == SIG_DFL;
}

}  // namespace

sigset_t ending_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  for (const int signal : {SIGHUP, SIGQUIT, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGIO, SIGPWR, SIGXCPU}) {
    if (has_default_action(signal)) sigaddset(&signals, signal);
  }
  return signals;
}

void take_file_limit_as_error() { std::signal(SIGXFSZ, SIG_IGN); }

}  // namespace ringdown
