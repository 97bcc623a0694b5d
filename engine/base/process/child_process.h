// Runs another program to its end. [worker]
//
//   const Result<ChildOutcome> done = run_child({.command = {"mpirun", "-n", "2", program}, .on_line = show});
//   if (!done) return fail(done);          // it could not be started
//   if (done->exit_code != 0) return fail(ErrorKind::refused, last_line(done->errors));
//
// The program starts with no signal blocked, gets SIGTERM when the thread that runs it ends, and never outlives
// run_child().
#pragma once

#include "engine/base/result.h"

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown {

struct ChildRequest {
  std::vector<std::string> command;                // the program is searched in PATH when its name has no '/'
  std::map<std::string, std::string> environment;  // added to this process's environment
  std::filesystem::path folder;                    // working directory; empty: this process's
  double limit_s = 0;                              // wall time after which the program is ended; 0: no limit
  std::function<void(std::string_view)> on_line;   // called with each line of standard output
  std::function<bool()> keep_going;                // called every 50 ms; false ends the program
};

struct ChildOutcome {
  int exit_code = 0;         // 128 + signal when a signal ended the program
  bool stopped = false;      // keep_going returned false
  bool out_of_time = false;  // limit_s passed
  std::string errors;        // the last 8 kB of standard error
  double seconds = 0;        // wall time
  double processor_s = 0;    // processor time of the program and the children it waited for
  double peak_mib = 0;       // peak resident memory of the program or the largest child it waited for
};

// Fails only when the program cannot be started. A program is ended by SIGTERM, and half a second later by SIGKILL.
Result<ChildOutcome> run_child(const ChildRequest& request);

// The last line that is not empty, without blanks around it.
std::string last_line(std::string_view text);

// Finds the program `name` in the running program's folder or in the folder above, because tests lie one level deeper.
// Fails, naming both folders, if the program is in neither.
Result<std::filesystem::path> find_beside(const std::string& name);

}  // namespace ringdown
