#include "engine/fit/extent.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

// Finding the blow
//
// The recording is divided into blocks of 5 ms, of which only the peaks count. The peak of a quiet block, the tenth
// percentile, measures the noise. The search for the onset goes back from the first block with half of the largest peak
// as long as blocks stand above the noise; the blow begins in the earliest of these blocks, at the first sample above
// the threshold. It ends where another blow comes (a block twice as loud as all of the last 0.3 s), or where blocks
// hardly exceed the noise; in the latter case its length is doubled, because narrow bands hear further into the noise
// than blocks do. If the beginning is clipped, the fit starts after the last clipped sample.
namespace ringdown::fit {
namespace {

constexpr double kBlock_s = 0.005;
constexpr double kOverNoise = 4;       // threshold of an onset's first sample, relative to the peak of a quiet block
constexpr double kOverSilence = 0.01;  // lower limit of the onset's threshold, relative to the largest peak
constexpr double kAgain_s = 0.3;       // time for which the sound before a new blow is softer
constexpr double kAgain = 2;           // factor by which a new blow is louder
constexpr double kMinSteps = 4;        // rounding steps of the samples; a smaller peak is rounding noise

double peak_of(std::span<const double> samples) {
  double peak = 0;
  for (const double sample : samples) peak = std::max(peak, std::abs(sample));
  return peak;
}

std::vector<double> peaks_of_blocks(std::span<const double> samples, std::size_t block) {
  std::vector<double> peaks;
  for (std::size_t first = 0; first < samples.size(); first += block) {
    peaks.push_back(peak_of(samples.subspan(first, std::min(block, samples.size() - first))));
  }
  return peaks;
}

// The peak of a quiet block: the tenth percentile of all peaks.
double noise_peak(std::vector<double> peaks) {
  const auto place = peaks.begin() + static_cast<std::ptrdiff_t>(peaks.size() / 10);
  std::nth_element(peaks.begin(), place, peaks.end());
  return *place;
}

// The block in which the first blow begins that is nearly as loud as the loudest.
std::size_t onset_block(const std::vector<double>& peaks, double threshold) {
  const double loudest = *std::ranges::max_element(peaks);
  std::size_t block = 0;
  while (peaks[block] < 0.5 * loudest) ++block;
  while (block > 0 && peaks[block - 1] > threshold) --block;
  return block;
}

// The block in which another blow begins, or the number of blocks.
std::size_t next_blow(const std::vector<double>& peaks, std::size_t onset) {
  const auto memory = static_cast<std::size_t>(kAgain_s / kBlock_s);
  for (std::size_t block = onset + memory; block < peaks.size(); ++block) {
    const auto at = peaks.begin() + static_cast<std::ptrdiff_t>(block);
    const double before = *std::max_element(at - static_cast<std::ptrdiff_t>(memory) + 1, at);
    if (peaks[block] > kAgain * before && peaks[block] > kAgain * peaks[block - 1]) return block;
  }
  return peaks.size();
}

// The block in which the sound is lost in the noise: twice as far from the onset as the last block well above the
// noise, because in narrow bands the tail is heard for longer.
std::size_t lost_in_noise(const std::vector<double>& peaks, std::size_t onset, std::size_t end, double noise) {
  std::size_t last = end;
  while (last > onset + 1 && peaks[last - 1] < 1.5 * noise) --last;
  return std::min(end, onset + 2 * (last - onset));
}

// The smallest step between neighbouring samples that differ. If the samples were rounded, this is the rounding step.
double smallest_step(std::span<const double> samples) {
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t n = 1; n < samples.size(); ++n) {
    const double difference = std::abs(samples[n] - samples[n - 1]);
    if (difference > 0) step = std::min(step, difference);
  }
  return step;
}

// A clipped wave stays constant at its peak and falls steeply on both sides. If a round peak has three samples that
// differ by no more than a tolerance, its neighbours lie at most about four tolerances below. The tolerance is that of
// the comparison, or the samples' rounding step, which is large in a quiet recording.
struct Plateau {
  double level, min_fall;

  Plateau(std::span<const double> samples, double peak)
      : level(0.9999 * peak), min_fall(kSteep * std::max(peak - level, smallest_step(samples))) {}

  [[nodiscard]] bool holds(double sample) const { return std::abs(sample) >= level; }
  [[nodiscard]] bool falls_to(double sample, double side) const { return side * sample < level - min_fall; }

  static constexpr double kSteep = 6;
};

// The number of samples at the largest magnitude, if the wave is clipped there; `last` is one past the last of them.
std::size_t clipped_samples(std::span<const double> samples, double peak, std::size_t& last) {
  const Plateau plateau(samples, peak);
  std::size_t count = 0;
  bool clipped = false;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (!plateau.holds(samples[n])) continue;
    const std::size_t first = n;
    const double side = samples[n] < 0 ? -1 : 1;
    while (n + 1 < samples.size() && plateau.holds(samples[n + 1]) && side * samples[n + 1] > 0) ++n;
    count += n + 1 - first;
    last = n + 1;
    const bool rises = first == 0 || plateau.falls_to(samples[first - 1], side);
    const bool falls = n + 1 == samples.size() || plateau.falls_to(samples[n + 1], side);
    clipped |= n + 1 - first >= kClippedRun && rises && falls;
  }
  return clipped ? count : 0;
}

}  // namespace

std::optional<Extent> find_extent(std::span<const double> samples, double sample_rate_hz,
                                  std::optional<std::size_t> from) {
  const double loudest = peak_of(samples);
  if (!(loudest > 0) || loudest < kMinSteps * smallest_step(samples)) return {};
  const auto block = std::max<std::size_t>(1, static_cast<std::size_t>(kBlock_s * sample_rate_hz));
  const std::vector<double> peaks = peaks_of_blocks(samples, block);
  const double noise = noise_peak(peaks), threshold = std::max(kOverNoise * noise, kOverSilence * loudest);
  const bool begins_at_once = peaks.front() > 0.5 * loudest;
  if (!from && !begins_at_once && loudest < threshold) return {};
  Extent extent;
  const std::size_t first = from ? *from / block : begins_at_once ? 0 : onset_block(peaks, threshold);
  if (from) {
    extent.onset = *from;
  } else {
    extent.onset = first * block;
    const double min = std::min(threshold, 0.5 * loudest);
    while (!begins_at_once && std::abs(samples[extent.onset]) <= min) ++extent.onset;
  }
  const std::size_t end = lost_in_noise(peaks, first, next_blow(peaks, first), noise);
  extent.end = std::min(samples.size(), end * block);
  extent.start = extent.onset;
  std::size_t last_clipped = 0;
  const auto sound = samples.subspan(extent.onset, extent.end - std::min(extent.onset, extent.end));
  extent.clipped = clipped_samples(sound, peak_of(sound), last_clipped);
  if (extent.clipped > 0) extent.start = extent.onset + last_clipped;
  if (extent.start >= extent.end) return {};
  return extent;
}

}  // namespace ringdown::fit
