#include "engine/scene/ode_rolling.h"

#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>

namespace ringdown::scene {
namespace {

std::uint64_t key_of(BodyId one, BodyId two) { return std::uint64_t{std::min(one, two)} << 32 | std::max(one, two); }

// How fast a torque about the unit `axis` makes it turn about that axis. [1/(kg m^2)]
double readiness_to_turn(const Item& item, const Motion& motion, Vec3 axis) {
  if (!item.movable()) return 0;
  const Vec3 within = transpose(to_matrix(motion.rotation)) * axis;
  return dot(within, item.inverse_inertia * within);
}

}  // namespace

void Loads::note(std::span<const Touch> touches, double part_s) {
  loads_.clear();
  for (const Touch& touch : touches) {
    const std::uint64_t pair = key_of(touch.body, touch.other);
    const double force_n = std::abs(dot(touch.impulse_ns, touch.normal)) / part_s;
    if (!loads_.empty() && loads_.back().pair == pair) {
      loads_.back().force_n += force_n;  // the points of a pair are found together
    } else {
      loads_.push_back({pair, force_n});
    }
  }
  std::ranges::sort(loads_, {}, &Load::pair);
}

double Loads::of_n(BodyId one, BodyId two) const {
  const auto load = std::ranges::lower_bound(loads_, key_of(one, two), {}, &Load::pair);
  return load == loads_.end() || load->pair != key_of(one, two) ? 0 : load->force_n;
}

void resist_rolling(Item& body, Item& other, Vec3 point_m, Vec3 normal, double most_nm, Vec3 gravity_m_s2,
                    double part_s) {
  const Motion of_body = body.motion(), of_other = other.motion();
  const Vec3 turning = of_body.spin_rad_s - of_other.spin_rad_s;
  Vec3 wanted_nm;
  if (const double speed = length(turning); speed > 0) {
    const Vec3 axis = (1 / speed) * turning;
    const double ready = readiness_to_turn(body, of_body, axis) + readiness_to_turn(other, of_other, axis);
    wanted_nm = (-1 / (ready * part_s)) * turning;
  }
  if (!other.movable()) {
    const Vec3 rolls_down_nm = cross(of_body.position_m - point_m, body.mass_kg * gravity_m_s2);
    wanted_nm = wanted_nm - rolls_down_nm + dot(rolls_down_nm, normal) * normal;
  }
  const double size_nm = length(wanted_nm);
  if (!(size_nm > 0) || !std::isfinite(size_nm)) return;
  const Vec3 torque_nm = std::min(1.0, most_nm / size_nm) * wanted_nm;
  body.add_torque(torque_nm);
  if (other.movable()) other.add_torque(-1 * torque_nm);
}

}  // namespace ringdown::scene
