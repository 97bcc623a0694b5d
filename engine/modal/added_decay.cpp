#include "engine/modal/added_decay.h"

namespace ringdown::modal {

std::vector<double> added_decay(const StrikeMap& map, const ContactDamping& contact) {
  std::vector<double> decay(map.bank().mode_count(), 0.0), along(decay.size());
  const auto add = [&](Vec3 direction) {
    map.excite(contact.point_m, direction, along);
    for (std::size_t m = 0; m < decay.size(); ++m) decay[m] += 0.5 * contact.damping_ns_m * along[m] * along[m];
  };
  if (contact.damping_ns_m == 0) return decay;
  if (const double size = length(contact.direction); size > 0) {
    add((1 / size) * contact.direction);
  } else {
    for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) add(axis);
  }
  return decay;
}

}  // namespace ringdown::modal
