#include "protocol/exit_codes.h"

#include "engine/base/blas_memory.h"
#include "engine/base/process/signals.h"
#include "engine/base/within_memory.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>

namespace ringdown::protocol {

std::string exit_code_help() {
  std::string text;
  for (const auto& [code, meaning] : kExitMeanings) {
    text += formatted("{}{} ", text.empty() ? "Exit codes: " : ", ", static_cast<int>(code));
    text += meaning;
  }
  return text + ".";
}

ExitCode exit_code_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::bad_input:
    case ErrorKind::too_large:
      return ExitCode::bad_input;
    case ErrorKind::cancelled:
      return ExitCode::cancelled;
    case ErrorKind::usage:
      return ExitCode::usage;
    case ErrorKind::no_sound_server:
      return ExitCode::no_jack;
    case ErrorKind::port_busy:
      return ExitCode::port_busy;
    case ErrorKind::refused:
    case ErrorKind::no_memory:
    case ErrorKind::input_output:
      return ExitCode::failure;
  }
  return ExitCode::failure;
}

ExitCode complain(std::string_view sentence, ExitCode code) {
  std::fflush(stdout);
  std::fprintf(stderr, "%s: %.*s\n", program_invocation_short_name, static_cast<int>(sentence.size()), sentence.data());
  return code;
}

ExitCode complain(const Error& error) { return complain(error.message, exit_code_of(error.kind)); }

int exit_status(const std::function<ExitCode()>& work) {
  take_file_limit_as_error();
  if (const auto enough = check_blas_memory(); !enough) std::_Exit(static_cast<int>(complain(enough.error())));
  const auto code = within_memory("go on", [&work]() -> Result<ExitCode> { return work(); });
  return static_cast<int>(code ? *code : complain(code.error()));
}

}  // namespace ringdown::protocol
