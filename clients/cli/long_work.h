// Work that takes seconds to hours: a line of progress, and Ctrl-C as a request to stop.
#pragma once

#include "protocol/exit_codes.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>

namespace ringdown::cli {

// Shows the present stage of the work. [one thread]
class ProgressLine {
 public:
  enum class Style {
    none,
    bar,   // one line on stderr that begins with the title, rewritten in place
    lines  // for programs: lines "0.425 STAGE" on stdout, the fraction as in show()
  };
  ProgressLine(std::string title, Style style) : title_(std::move(title)), style_(style) {}
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // Writes at most ten times a second, and when the stage changes. `fraction` is in 0..1; 0 where it is not known.
  void show(std::string_view stage, double fraction);
  void clear();

 private:
  std::string title_;
  Style style_;
  std::string stage_;
  std::chrono::steady_clock::time_point shown_{};
};

// Runs `work` on a thread of its own and returns its exit code. [main]
//
// SIGINT, SIGTERM or another signal that would end the program asks the work to stop through the token. Work that has
// not returned after `patience` (inside gmsh or a factorisation, which cannot be asked) is abandoned and the process
// ends. Either way the exit code is `cancelled` and no half-written file is left: files are renamed into place when
// they are whole, and writing one takes milliseconds, or asks the token between its pieces. Work that runs out of
// memory has failed.
//
// Call run_cancellable() before any other thread exists: it blocks the signals for all of them.
protocol::ExitCode run_cancellable(const std::function<protocol::ExitCode(std::stop_token)>& work,
                                   std::chrono::milliseconds patience = std::chrono::seconds(1));

// Writes to stderr which features the kernel lacks for the sandbox in which mesh files are read, if any
// (engine/base/process/sandbox.h). [main]
void warn_of_open_sandbox();

// Writes why `output` was not written, and returns the exit code for it.
protocol::ExitCode complain_unwritten(const Error& error, const std::filesystem::path& output);

}  // namespace ringdown::cli
