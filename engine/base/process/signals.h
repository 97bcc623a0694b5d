// The signals that ask a program to end. [main]
#pragma once

#include <csignal>

namespace ringdown {

// Returns the signals that would end this program and that a person, a service or a limit sends: SIGINT and SIGTERM
// always; SIGHUP, SIGQUIT, SIGUSR1, SIGUSR2, timers, SIGPWR and SIGXCPU unless they are ignored or handled. SIGHUP
// stays ignored if it was ignored when the program started, as under nohup.
sigset_t ending_signals();

// Makes a write beyond the limit of file sizes (ulimit -f) fail like a write to a full disk. By default SIGXFSZ would
// end the program without a message.
void take_file_limit_as_error();

}  // namespace ringdown
