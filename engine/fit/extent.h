// Finds the blow in a recording, and how long it is heard. [any]
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace ringdown::fit {

// Sample numbers.
struct Extent {
  std::size_t onset = 0;    // the sound's first rise out of the noise before the largest peak
  std::size_t start = 0;    // the onset, or the sample after the last clipped one
  std::size_t end = 0;      // the point where the sound is lost in noise, the next blow, or the end of the recording
  std::size_t clipped = 0;  // samples at the largest magnitude, if the wave is cut off there for kClippedRun samples
};

inline constexpr std::size_t kClippedRun = 3;

// Finds the extent of samples without an offset. `from` is the onset if it is known. Empty when no sample stands out of
// the noise.
std::optional<Extent> find_extent(std::span<const double> samples, double sample_rate_hz,
                                  std::optional<std::size_t> from);

}  // namespace ringdown::fit
