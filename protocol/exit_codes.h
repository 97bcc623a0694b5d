// Exit codes of all programs of Ringdown: one list, so that a script may rely on them, and the one place where the kind
// of an error becomes an exit code. [main]
#pragma once

#include "engine/base/result.h"

#include <functional>
#include <string>
#include <string_view>

namespace ringdown::protocol {

enum class ExitCode : int {
  ok = 0,
  failure = 1,      // anything that no other code names
  usage = 2,        // a wrong option or argument
  bad_input = 3,    // a file that cannot be read or is not what it should be
  no_jack = 4,      // no JACK server answers
  port_busy = 5,    // a network port cannot be opened
  no_answer = 6,    // no daemon answered in time
  silence = 7,      // what was rendered is digital silence
  cancelled = 130,  // SIGINT, as shells count it: 128 + 2
};

// The words for each code in --help and in the man pages.
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
    {ExitCode::silence, "nothing but silence was rendered"},
    {ExitCode::cancelled, "cancelled"},
};

// "Exit codes: 0 ok, 1 failure, ...": printed by the programs' --help.
std::string exit_code_help();

// bad_input and too_large become bad_input; no_sound_server becomes no_jack; usage, port_busy and cancelled keep their
// names; refused, no_memory and input_output are failures.
ExitCode exit_code_of(ErrorKind kind);

// Prints "PROGRAM: SENTENCE" to the standard error, after everything that was printed to the standard output, and
// returns `code`. PROGRAM is the name by which the program was called, without folders.
ExitCode complain(std::string_view sentence, ExitCode code);

// Prints the error's sentence and returns the exit code for its kind.
ExitCode complain(const Error& error);
template <class T>
ExitCode complain(const Result<T>& failed) {
  return complain(failed.error());
}

// Runs a program's work, for main() to return. A lack of memory or of threads is complained of like any failure, and so
// is a file that reaches the limit of its size.
int exit_status(const std::function<ExitCode()>& work);

}  // namespace ringdown::protocol
