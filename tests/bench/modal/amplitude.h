// The part `amplitude` of the modal benchmark: how far a strike anywhere is from what the finite elements say.
#pragma once

#include "engine/base/result.h"
#include "tests/bench/promise.h"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace ringdown::bench {

struct AmplitudePlan {
  std::vector<std::filesystem::path> objects;  // object files; empty: six of the presets, or all with `all`
  bool all = false, quick = false;             // quick: two presets, a tenth of the points
  bool compress = false;                       // baked banks, as the presets are
  std::filesystem::path bank;                  // to be measured instead of the preset's; with one object
  std::filesystem::path cache;                 // folder of solutions
  std::filesystem::path folder;                // for the banks that are baked
  std::filesystem::path csv;                   // a row for each bank
  std::filesystem::path by_mode;        // tsv: object, bank, points, frequency [Hz], error of each mode; empty: none
  std::vector<std::size_t> max_points;  // of baked banks, one of each, instead of the object's; empty: the object's
};

// Bakes each object, and measures the bank as written and read back, and the preset's bank beside it when there is one
// (amplitude_error.h). Prints a line and writes a row for each. Promises a median of the modes of at most 3 %, and no
// mode and no region above 10 %; an object that cannot be baked or measured misses its promise. Fails when the CSV
// cannot be written.
Result<std::vector<Promise>> measure_amplitudes(const AmplitudePlan& plan);

}  // namespace ringdown::bench
