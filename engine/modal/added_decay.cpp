#include "engine/modal/added_decay.h"

namespace ringdown::modal {

// A damper without a direction resists motion along all three axes.
std::vector<double> added_decay(const StrikeMap& map, const Dampers& dampers) {
  std::vector<double> decay(map.bank().mode_count(), 0.0), along(decay.size());
  const auto add = [&](const Damper& damper, Vec3 direction) {
    map.excite(damper.point_m, direction, along);
    for (std::size_t m = 0; m < decay.size(); ++m) decay[m] += 0.5 * damper.damping_ns_m * along[m] * along[m];
  };
  for (const auto& [number, damper] : dampers) {
    if (damper.damping_ns_m == 0) continue;
    if (const double size = length(damper.direction); size > 0) {
      add(damper, (1 / size) * damper.direction);
    } else {
      for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) add(damper, axis);
    }
  }
  return decay;
}

}  // namespace ringdown::modal
