// Detects a body that stays in place although its velocity trembles. The solver leaves some bodies that lie askew on
// each other trembling for ever, by a few hundredths of a millimetre per step; real trembling would lose its energy.
// [one thread]
#pragma once

#include "engine/scene/description.h"
#include "engine/scene/rotation.h"

#include <algorithm>

namespace ringdown::scene {

class Stillness {
 public:
  // Restarts the measurement. Call when the body moves on purpose.
  void reset() { still_s_ = 0; }

  // Call after each step with the pose at its end. A body is still while no point of it moves from its place by more
  // than two millimetres, or by more than a fiftieth of `outer_radius_m`, its farthest extent from its centre.
  void step(const Pose& pose, double outer_radius_m, double step_s) {
    const double limit_m = std::min(0.002, 0.02 * outer_radius_m);
    const double way_m = length(pose.position_m - place_.position_m) +
                         outer_radius_m * length(to_rotation_vector(inverse(place_.rotation) * pose.rotation));
    if (still_s_ > 0 && way_m <= limit_m) {
      still_s_ += step_s;
    } else {
      place_ = pose;
      still_s_ = step_s;
    }
  }

  [[nodiscard]] double still_s() const { return still_s_; }

 private:
  Pose place_;
  double still_s_ = 0;
};

}  // namespace ringdown::scene
