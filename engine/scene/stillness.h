// Whether a body stays where it is, however its velocity trembles. The solver leaves some bodies trembling that lie on
// each other askew, by a few hundredths of a millimetre from step to step and for ever; what trembles in truth loses
// its energy. [one thread]
#pragma once

#include "engine/scene/description.h"
#include "engine/scene/rotation.h"

#include <algorithm>

namespace ringdown::scene {

class Stillness {
 public:
  // Begins anew: the body moves on purpose.
  void reset() { still_s_ = 0; }

  // After a step that has ended with `pose`. No point of a body that reaches `outer_radius_m` from its centre may leave
  // its place by more than two millimetres, or by more than a fiftieth of that radius.
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
