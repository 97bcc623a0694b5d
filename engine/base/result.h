// Result<T>: a value, or an error: the kind of failure for the program, and for the person one sentence that says what
// failed, where, and what to do. [any thread]
//
// Used for everything that can fail because of the outside world: files, solvers, OSC input. Programmer mistakes
// are assertions. No exception leaves a public function of Ringdown.
//
//   Result<Bank> bank = read_bank(path);
//   if (!bank) return fail(bank);                  // passed on
//   if (!bank) return fail("object bell", bank);   // passed on, with a name before the sentence: "object bell: ..."
//   if (bank->empty()) return fail(ErrorKind::bad_input, "{} has no modes; bake the object again", path.string());
//
// A caller decides by the kind and prints the sentence; it never reads the sentence to find out what happened.
// protocol/exit_codes.h has the exit code for each kind.
#pragma once

#include "engine/base/formatted.h"

#include <tl/expected.hpp>

#include <string>
#include <string_view>
#include <utility>

namespace ringdown {

enum class ErrorKind {
  bad_input,        // a file or a message is missing, unreadable, or not what it should be
  too_large,        // the input is sound but exceeds one of our limits: bytes, elements, modes, bodies, objects
  refused,          // the request is sound but impossible here or now: a full queue, a missing program, no convergence
  cancelled,        // the caller asked to stop
  no_memory,        // the computer has not enough memory
  input_output,     // the operating system could not write, read on, send, or start a process
  usage,            // an option or argument of a program is wrong
  no_sound_server,  // no JACK server answers
  port_busy,        // a network port cannot be opened: another program has it, or it is not ours
};

struct Error {
  ErrorKind kind;
  std::string message;
};

template <class T>
using Result = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> fail(ErrorKind kind, std::string sentence) {
  return tl::make_unexpected(Error{kind, std::move(sentence)});
}
template <class Value, class... Values>
[[nodiscard]] tl::unexpected<Error> fail(ErrorKind kind, Pattern<Value, Values...> pattern, const Value& value,
                                         const Values&... values) {
  return fail(kind, formatted<Value, Values...>(pattern, value, values...));
}
[[nodiscard]] inline tl::unexpected<Error> fail(Error error) { return tl::make_unexpected(std::move(error)); }
template <class T>
[[nodiscard]] tl::unexpected<Error> fail(const Result<T>& failed) {
  return fail(failed.error());
}
template <class T>
[[nodiscard]] tl::unexpected<Error> fail(std::string_view name, const Result<T>& failed) {
  return fail(failed.error().kind, formatted("{}: {}", name, failed.error().message));
}

}  // namespace ringdown
