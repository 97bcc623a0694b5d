// Heights of a surface along a path over it, measured or drawn, at equal steps. The path repeats from its end.
//
// A moving contact feels the slope of the heights, smoothed over the width of the contact region. A track therefore
// keeps its heights in levels, each with half as many as the level before, and a slope is blended from the two levels
// whose steps are nearest to that width. For audio threads and the readers of scenes.
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

  // Selects two neighbouring levels and the share of the coarser one, so that heights are smoothed over about `width_m`
  // and steps are no shorter than `step_m`, the distance travelled in one frame. [any]
  struct Blend {
    std::size_t level = 0;
    double coarser = 0;  // share of level + 1
  };
  [[nodiscard]] Blend blend(double width_m, double step_m) const REALTIME;

  // The slope of the heights at any distance `at_m` from the first height. [audio]
  [[nodiscard]] double slope_at(double at_m, Blend blend) const REALTIME;

  [[nodiscard]] double length_m() const { return length_m_; }
  [[nodiscard]] double rms_slope() const { return rms_slope_; }  // of the heights themselves
  [[nodiscard]] std::span<const float> heights_m() const { return levels_.front(); }

 private:
  SurfaceTrack() = default;
  [[nodiscard]] double slope_in(std::size_t level, double at_m) const REALTIME;

  std::vector<std::vector<float>> levels_;  // each has at least kMinHeights heights; the last is flat
  double length_m_ = 0, rms_slope_ = 0;
};

// The two scales of a surface's relief. A mixer's events point to the relief, so the sender must keep it alive.
struct SurfaceRelief {
  std::optional<SurfaceTrack> profile;  // the measured finish; absent: a random one is used
  std::optional<SurfaceTrack> mesoscale;
};

}  // namespace ringdown::modal
