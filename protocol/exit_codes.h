// Exit codes of all programs of Ringdown: one list, so that a script may rely on them.
#pragma once

#include <string>
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

// What a script's author wants to know of each.
struct ExitMeaning {
  ExitCode code;
  std::string_view meaning;
};
inline constexpr ExitMeaning kExitMeanings[] = {
    {ExitCode::ok, "ok"},
    {ExitCode::failure, "failure"},
    {ExitCode::usage, "usage"},
    {ExitCode::bad_input, "bad input file"},
    {ExitCode::no_jack, "no JACK server"},
    {ExitCode::port_busy, "port busy"},
    {ExitCode::no_answer, "no answer from the daemon"},
    {ExitCode::cancelled, "cancelled"},
};

// "Exit codes: 0 ok, 1 failure, ...": printed by the programs' --help.
inline std::string exit_code_help() {
  std::string text;
  for (const auto& [code, meaning] : kExitMeanings) {
    text += (text.empty() ? "Exit codes: " : ", ") + std::to_string(static_cast<int>(code)) + " ";
    text += meaning;
  }
  return text + ".";
}

}  // namespace ringdown::protocol
