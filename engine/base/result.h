// Result<T>: a value, or one sentence that says what failed, where, and what to do.
//
// Used for everything that can fail because of the outside world: files, solvers, OSC input. Programmer mistakes
// are assertions. No exception leaves a public function of Ringdown.
//
//   Result<Bank> bank = read_bank(path);
//   if (!bank) return fail(bank.error());
#pragma once

#include <tl/expected.hpp>

#include <string>
#include <utility>

namespace ringdown {

struct Error {
  std::string message;
};

template <class T>
using Result = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> fail(std::string message) {
  return tl::make_unexpected(Error{std::move(message)});
}
[[nodiscard]] inline tl::unexpected<Error> fail(Error error) { return tl::make_unexpected(std::move(error)); }

}  // namespace ringdown
