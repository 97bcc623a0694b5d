// Another program, run to its end. [worker]
//
//   const Result<ChildOutcome> done = run_child({.command = {"mpirun", "-n", "2", program}, .on_line = show});
//   if (!done) return fail(done.error());          // it could not be started
//   if (done->exit_code != 0) return fail(ErrorKind::refused, last_line(done->errors));
//
// It starts with no signal blocked, gets SIGTERM when the thread that runs it ends, and never outlives run_child().
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
  std::map<std::string, std::string> environment;  // added to ours
  std::filesystem::path folder;                    // it works in; empty: ours
  double limit_s = 0;                              // of wall time, then it is ended; 0: none
  std::function<void(std::string_view)> on_line;   // each line of its standard output, as it comes
  std::function<bool()> keep_going;                // asked every 50 ms; false ends it
};

struct ChildOutcome {
  int exit_code = 0;         // 128 + signal when one ended it
  bool stopped = false;      // keep_going said no
  bool out_of_time = false;  // limit_s passed
  std::string errors;        // the end of its standard error, at most 8 kB
  double seconds = 0;        // wall time
  double processor_s = 0;    // of it and of those it waited for
  double peak_mib = 0;       // resident: of it, or of the largest of those it waited for
};

// Fails only when the program cannot be started. Ending it: SIGTERM, and SIGKILL half a second later.
Result<ChildOutcome> run_child(const ChildRequest& request);

// The last line that is not empty, without blanks around it.
std::string last_line(std::string_view text);

// `name` beside the running program or in the folder above that (tests lie one deeper); fails with both places.
Result<std::filesystem::path> find_beside(const std::string& name);

}  // namespace ringdown
