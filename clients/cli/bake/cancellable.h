// Work that Ctrl-C ends. [main thread]
#pragma once

#include "protocol/exit_codes.h"

#include <chrono>
#include <functional>
#include <stop_token>

namespace ringdown::cli {

// Runs `work` on a thread of its own and returns its exit code. SIGINT or SIGTERM asks it to stop through the
// token; work that has not come back after `patience` (inside gmsh or a factorisation, which cannot be asked)
// is left where it is and the process ends. Both ways the exit code is `cancelled` and no half-written file is left:
// banks are renamed into place when whole, and writing one takes milliseconds.
//
// Call before any other thread exists: it blocks the two signals for all of them.
protocol::ExitCode run_cancellable(const std::function<protocol::ExitCode(std::stop_token)>& work,
                                   std::chrono::milliseconds patience = std::chrono::seconds(1));

}  // namespace ringdown::cli
