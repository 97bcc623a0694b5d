// A system that has run out of something. For the rest of the process: use it in the statement of an EXPECT_EXIT.
#pragma once

#include <cstdlib>
#include <fstream>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

namespace ringdown::test {

inline void set_limit(__rlimit_resource resource, rlim_t max) {
  rlimit limit{};
  if (::getrlimit(resource, &limit) != 0) std::_Exit(99);
  limit.rlim_cur = max;
  if (::setrlimit(resource, &limit) != 0) std::_Exit(99);
}

// Nothing more can be opened.
inline void run_out_of_descriptors() {
  const int next = ::dup(STDIN_FILENO);
  if (next < 0) return;
  ::close(next);
  set_limit(RLIMIT_NOFILE, static_cast<rlim_t>(next));
}

// No thread can be started, because its stack finds no room, or one if there are 12 MiB of it. The process must not
// have ended a thread before, whose stack would be used again: choose the death tests' style "threadsafe". Of no use
// under sanitizers, which map terabytes.
inline void run_out_of_threads(rlim_t room_mib = 4) {
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  set_limit(RLIMIT_AS, pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + (room_mib << 20));
}

}  // namespace ringdown::test
