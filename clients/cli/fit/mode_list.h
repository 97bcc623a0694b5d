// A list of measured modes, modes.csv, in place of recordings. [any thread]
//
//   frequency_hz,t60_s
//   116716,
//   143783,0.02
//
// The first line names the columns; frequency_hz is required, t60_s and decay_per_s are read if they are there, and
// others are skipped. Lines that are empty or begin with # count for nothing.
#pragma once

#include "engine/base/result.h"
#include "engine/fit/modes.h"

#include <filesystem>
#include <vector>

namespace ringdown::cli {

// Sorted by frequency, each with an amplitude of 1; a decay that is not known is 0. Fails for a file without a mode,
// and for what is not a number above 0, with its line.
Result<std::vector<fit::Mode>> read_mode_list(const std::filesystem::path& path);

}  // namespace ringdown::cli
