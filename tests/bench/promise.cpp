#include "tests/bench/promise.h"

#include <array>
#include <cstdio>

namespace ringdown::bench {
namespace {

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

}  // namespace

Promise at_least(const std::string& what, double value, double min, bool bound) {
  const bool good = value >= min;
  return {what + (bound ? " > " : " ") + text("%.2f", value) + text(" (at least %g)", min),
          good ? Promise::kPass : Promise::kMissed};
}

Promise at_most(const std::string& what, double value, double max, const char* unit) {
  return {what + text(" %.3g", value) + unit + text(" (at most %g", max) + unit + ")",
          value <= max ? Promise::kPass : Promise::kMissed};
}

bool report(const std::vector<Promise>& promises) {
  constexpr std::array kVerdicts = {"pass  ", "MISSED", "-     "};
  std::array<int, 3> counts{};
  std::printf("\n");
  for (const Promise& promise : promises) {
    std::printf("%s  %s\n", kVerdicts[promise.verdict], promise.sentence.c_str());
    ++counts[promise.verdict];
  }
  std::printf("\n%d passed, %d missed, %d not measured\n", counts[0], counts[1], counts[2]);
  return counts[1] == 0;
}

}  // namespace ringdown::bench
