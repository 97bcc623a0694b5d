#include "engine/base/free_memory.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

namespace ringdown {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

// Reads the line "MemAvailable:  123 kB".
double available() {
  std::ifstream in("/proc/meminfo");
  std::string word;
  double kib = 0;
  while (in >> word) {
    if (word == "MemAvailable:" && in >> kib) return 1024 * kib;
  }
  return kNone;
}

// Returns the first number of a file, or infinity if there is none ("max" in a control group without limit).
double number_in(const std::string& path) {
  std::ifstream in(path);
  double number = 0;
  return in >> number ? number : kNone;
}

// Returns the memory that is left within the innermost control group (version 2) with a limit.
double left_in_group() {
  std::ifstream in("/proc/self/cgroup");
  std::string line;
  while (std::getline(in, line)) {
    if (!line.starts_with("0::/")) continue;
    double min = kNone;
    for (std::string group = line.substr(3);; group.resize(group.find_last_of('/'))) {
      const std::string folder = "/sys/fs/cgroup" + group;
      min = std::min(min, number_in(folder + "/memory.max") - number_in(folder + "/memory.current"));
      if (group.find_last_of('/') == std::string::npos || group.empty()) return min;
    }
  }
  return kNone;
}

double left_of_address_space() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kNone;
  const double taken = number_in("/proc/self/statm") * static_cast<double>(::sysconf(_SC_PAGESIZE));
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - taken);
}

}  // namespace

double free_memory_bytes() { return std::min({available(), left_in_group(), left_of_address_space()}); }

}  // namespace ringdown
