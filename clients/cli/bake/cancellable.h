// Work that Ctrl-C ends. [main thread]
#pragma once

#include <functional>
#include <stop_token>

namespace ringdown::cli {

inline constexpr int kExitCancelled = 130; // 128 + SIGINT, what shells expect

// Runs `work` on a thread of its own and returns its exit code. SIGINT or SIGTERM asks it to stop through the
// token; work that has not come back after one second (inside gmsh or a factorisation, which cannot be asked)
// is left where it is and the process ends. Both ways the exit code is 130 and no half-written file is left:
// banks are renamed into place when whole, and writing one takes milliseconds.
//
// Call before any other thread exists: it blocks the two signals for all of them.
int run_cancellable(const std::function<int(std::stop_token)>& work);

} // namespace ringdown::cli
