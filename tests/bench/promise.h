// What a benchmark promises, and whether a run kept it.
#pragma once

#include <string>
#include <vector>

namespace ringdown::bench {

struct Promise {
  std::string sentence;  // "block, 60291 unknowns, 200 modes: times as fast as Spectra over CHOLMOD 3.4 (at least 3)"
  enum { kPass, kMissed, kNotMeasured } verdict = kNotMeasured;  // kNotMeasured: not asked for, or no such peer here
};

// `bound`: the value is known to be larger than this.
Promise at_least(const std::string& what, double value, double min, bool bound = false);
Promise at_most(const std::string& what, double value, double max, const char* unit);

// Prints them, and "N passed, N missed, N not measured". True when none was missed.
bool report(const std::vector<Promise>& promises);

}  // namespace ringdown::bench
