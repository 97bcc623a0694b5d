#include "tests/bench/machine.h"

#include <algorithm>
#include <fstream>
#include <sched.h>
#include <thread>

namespace ringdown::bench {
namespace {

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown processor";
}

}  // namespace

std::string this_machine(const std::string& library) {
  const unsigned cores = std::thread::hardware_concurrency();
  std::string text = processor() + "; " + std::to_string(cores) + (cores == 1 ? " core; " : " cores; ") + library;
  std::replace(text.begin(), text.end(), ',', ' ');
  return text;
}

void hold_to_cores(int count) {
  static const cpu_set_t allowed = [] {
    cpu_set_t at_start;
    ::sched_getaffinity(0, sizeof at_start, &at_start);
    return at_start;
  }();
  cpu_set_t kept;
  CPU_ZERO(&kept);
  for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&kept) < count; ++cpu) {
    if (CPU_ISSET(cpu, &allowed)) CPU_SET(cpu, &kept);
  }
  ::sched_setaffinity(0, sizeof kept, &kept);
}

}  // namespace ringdown::bench
