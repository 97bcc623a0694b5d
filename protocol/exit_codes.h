// Exit codes of all programs of Ringdown: one list, so that a script may rely on them.
#pragma once

#include <string_view>

namespace ringdown::protocol {

enum class ExitCode : int {
  ok = 0,
  failure = 1,      // anything that no other code names
  usage = 2,        // a wrong option or argument
  bad_input = 3,    // a file that cannot be read or is not what it should be
  no_jack = 4,      // no JACK server answers
  port_busy = 5,    // the OSC port cannot be bound
  no_answer = 6,    // no daemon answered in time
  cancelled = 130,  // SIGINT, as shells count it: 128 + 2
};

// What a script's author wants to know, one line per code; printed by the programs' --help.
inline constexpr std::string_view kExitCodeHelp =
    "Exit codes: 0 ok, 1 failure, 2 usage, 3 bad input file, 4 no JACK server, 5 port busy, "
    "6 no answer from the daemon, 130 cancelled.";

}  // namespace ringdown::protocol
