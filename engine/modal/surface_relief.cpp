#include "engine/modal/surface_relief.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::modal {
namespace {

constexpr std::size_t kMinHeights = 4;  // of a level: a cubic goes through four
constexpr int kTaps = 8;                // parts of a step over which a coarser height is averaged
constexpr double kStepsPerWidth = 2;    // number of its steps over which a level is smooth

// Returns a level with half as many heights. Each is the mean over two of the new steps, weighted by a triangle.
std::vector<float> halved(const std::vector<float>& fine) {
  const std::size_t count = fine.size() / 2;
  const double ratio = static_cast<double>(fine.size()) / static_cast<double>(count);
  const auto height_at = [&fine](double at) {
    const double floor = std::floor(at), part = at - floor;
    const auto n = static_cast<std::ptrdiff_t>(fine.size());
    const auto wrapped = [n](std::ptrdiff_t k) { return static_cast<std::size_t>((k % n + n) % n); };
    const auto k = static_cast<std::ptrdiff_t>(floor);
    return (1 - part) * static_cast<double>(fine[wrapped(k)]) + part * static_cast<double>(fine[wrapped(k + 1)]);
  };
  std::vector<float> coarse(count);
  for (std::size_t k = 0; k < count; ++k) {
    double sum = 0, weights = 0;
    for (int tap = 1 - kTaps; tap < kTaps; ++tap) {
      const double off = static_cast<double>(tap) / kTaps, weight = 1 - std::abs(off);
      sum += weight * height_at(ratio * (static_cast<double>(k) + off));
      weights += weight;
    }
    coarse[k] = static_cast<float>(sum / weights);
  }
  return coarse;
}

}  // namespace

Result<SurfaceTrack> SurfaceTrack::make(std::span<const float> heights_m, double spacing_m) {
  if (heights_m.size() < 2 || heights_m.size() > kMaxTrackSamples)
    return fail(ErrorKind::bad_input, "a surface's track has 2 to {} heights", kMaxTrackSamples);
  if (!(spacing_m > 0) || !std::isfinite(spacing_m))
    return fail(ErrorKind::bad_input, "the heights of a surface's track lie more than 0 m apart");
  if (!std::ranges::all_of(heights_m, [](float h) { return std::isfinite(h); }))
    return fail(ErrorKind::bad_input, "a height of a surface's track is not a finite number");
  SurfaceTrack track;
  std::vector<float> first;
  while (first.size() < kMinHeights) first.insert(first.end(), heights_m.begin(), heights_m.end());
  const std::size_t count = first.size();
  track.length_m_ = spacing_m * static_cast<double>(count);
  track.levels_.push_back(std::move(first));
  while (track.levels_.back().size() >= 2 * kMinHeights) {
    std::vector<float> coarse = halved(track.levels_.back());
    track.levels_.push_back(std::move(coarse));
  }
  track.levels_.emplace_back(kMinHeights, 0.F);  // averaged over more than the whole track, the slope is zero
  double sum = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double slope = track.slope_in(0, (static_cast<double>(k) + 0.5) * spacing_m);
    sum += slope * slope;
  }
  track.rms_slope_ = std::sqrt(sum / static_cast<double>(count));
  return track;
}

SurfaceTrack::Blend SurfaceTrack::blend(double width_m, double step_m) const REALTIME {
  const double spacing_m = length_m_ / static_cast<double>(levels_[0].size());
  const double wanted_m = std::max(width_m, kStepsPerWidth * step_m) / kStepsPerWidth;
  if (!(wanted_m > spacing_m)) return {};
  const double level = std::log2(wanted_m / spacing_m), last = static_cast<double>(levels_.size() - 1);
  if (level >= last) return {levels_.size() - 1, 0};
  return {static_cast<std::size_t>(level), level - std::floor(level)};
}

double SurfaceTrack::slope_at(double at_m, Blend blend) const REALTIME {
  const double fine = slope_in(blend.level, at_m);
  return blend.coarser == 0 ? fine : (1 - blend.coarser) * fine + blend.coarser * slope_in(blend.level + 1, at_m);
}

// The derivative of the cubic of Catmull and Rom (1974), which goes through the heights.
double SurfaceTrack::slope_in(std::size_t level, double at_m) const REALTIME {
  const std::vector<float>& heights = levels_[level];
  const auto count = static_cast<double>(heights.size());
  const double per_m = count / length_m_;
  double at = at_m * per_m;
  at -= count * std::floor(at / count);
  const double floor = std::floor(at), t = at - floor;
  const auto n = heights.size();
  const std::size_t k = std::min(static_cast<std::size_t>(floor), n - 1);
  const auto height = [&](std::size_t j) { return static_cast<double>(heights[j < n ? j : j - n]); };
  const double p0 = height(k + n - 1), p1 = height(k), p2 = height(k + 1), p3 = height(k + 2);
  const double slope = 0.5 * (p2 - p0) + t * (2 * p0 - 5 * p1 + 4 * p2 - p3) + 1.5 * t * t * (p3 - p0 + 3 * (p1 - p2));
  return slope * per_m;
}

}  // namespace ringdown::modal
