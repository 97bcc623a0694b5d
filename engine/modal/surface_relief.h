// Heights of a surface along the way over it, measured or drawn, at even steps in a circle.
//
// A contact that travels over a surface feels the slope of its heights, smoothed over the width of the region that
// bears. A track therefore keeps its heights in levels, each of half as many as the one before, and a slope comes from
// the two levels whose steps are nearest to that width. For audio threads and the readers of scenes.
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/result.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace ringdown::modal {

inline constexpr std::size_t kMaxTrackSamples = std::size_t{1} << 20;

class SurfaceTrack {
 public:
  // Heights [m], 2 to kMaxTrackSamples of them, `spacing_m` > 0 apart. Fails when one is not finite. [worker]
  static Result<SurfaceTrack> make(std::span<const float> heights_m, double spacing_m);

  // Which levels are used, and how much of the coarser one: for features smoothed over about `width_m`, and of steps no
  // shorter than `step_m`, the way in one frame. [any]
  struct Blend {
    std::size_t level = 0;
    double coarser = 0;  // share of level + 1
  };
  [[nodiscard]] Blend blend(double width_m, double step_m) const RINGDOWN_REALTIME;

  // The slope of the heights at a place, which may be any distance from the first. [audio]
  [[nodiscard]] double slope_at(double at_m, Blend blend) const RINGDOWN_REALTIME;

  [[nodiscard]] double length_m() const { return length_m_; }
  [[nodiscard]] double rms_slope() const { return rms_slope_; }  // of the heights themselves
  [[nodiscard]] std::span<const float> heights_m() const { return levels_.front(); }

 private:
  SurfaceTrack() = default;
  [[nodiscard]] double slope_in(std::size_t level, double at_m) const RINGDOWN_REALTIME;

  std::vector<std::vector<float>> levels_;  // of at least kFewest heights each; the last is flat
  double length_m_ = 0, rms_slope_ = 0;
};

// Both scales of one surface below its shape. Events of a mixer point to it, so whoever sends them keeps it.
struct SurfaceRelief {
  std::optional<SurfaceTrack> profile;  // its finish as it was measured, in place of a random one
  std::optional<SurfaceTrack> mesoscale;
};

}  // namespace ringdown::modal
