// The peer scsynth: synths of 100 modes in its `Klank`, run as fast as it can (-N).
//
// White noise drives them all the time, so that no mode dies away or comes near denormal numbers. What Klank costs is
// the difference between a run with modes and one without, both with the noise.
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <filesystem>

namespace ringdown::bench {

bool scsynth_installed();

struct KlankRun {
  double processor_s = 0;
  double peak_bytes = 0;
};

inline constexpr std::size_t kKlankModes = 100;  // of one synth

// Renders `seconds` of `modes` modes, a multiple of kKlankModes, in blocks of `block`. Works in `folder`, which exists.
// Fails when the end of what it wrote is not sound.
Result<KlankRun> run_klank(std::size_t modes, std::size_t block, double seconds, const std::filesystem::path& folder);

}  // namespace ringdown::bench
