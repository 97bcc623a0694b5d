#include "engine/scene/ode/rolling.h"

#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>

namespace ringdown::scene {
namespace {

std::uint64_t key_of(BodyId one, BodyId two) { return std::uint64_t{std::min(one, two)} << 32 | std::max(one, two); }

// The angular acceleration about the unit `axis` per torque about that axis. [1/(kg m^2)]
double inverse_moment(const Collider& collider, const Motion& motion, Vec3 axis) {
  if (!collider.movable()) return 0;
  const Vec3 within = transpose(to_matrix(motion.rotation)) * axis;
  return dot(within, collider.inverse_inertia * within);
}

}  // namespace

void ContactLoads::set(std::span<const ContactPoint> points, double part_s) {
  loads_.clear();
  for (const ContactPoint& point : points) {
    const std::uint64_t pair = key_of(point.body, point.other);
    const double force_n = std::abs(dot(point.impulse_ns, point.normal)) / part_s;
    if (!loads_.empty() && loads_.back().pair == pair) {
      loads_.back().force_n += force_n;  // the points of one pair follow each other
    } else {
      loads_.push_back({pair, force_n});
    }
  }
  std::ranges::sort(loads_, {}, &Load::pair);
}

double ContactLoads::of_n(BodyId one, BodyId two) const {
  const auto load = std::ranges::lower_bound(loads_, key_of(one, two), {}, &Load::pair);
  return load == loads_.end() || load->pair != key_of(one, two) ? 0 : load->force_n;
}

// The required torque stops the relative spin within this part of the step: minus the spin, over the time and the two
// bodies' inverse moments about its axis. Against an immovable body it also balances the torque by which gravity would
// roll the body down its slope, without its component along the contact normal. The torque is limited to the load times
// the coefficient of rolling resistance.
void resist_rolling(Collider& body, Collider& other, Vec3 point_m, Vec3 normal, double limit_nm, Vec3 gravity_m_s2,
                    double part_s) {
  const Motion of_body = body.motion(), of_other = other.motion();
  const Vec3 turning = of_body.spin_rad_s - of_other.spin_rad_s;
  Vec3 needed_nm;
  if (const double speed = length(turning); speed > 0) {
    const Vec3 axis = (1 / speed) * turning;
    const double inverse_sum = inverse_moment(body, of_body, axis) + inverse_moment(other, of_other, axis);
    needed_nm = (-1 / (inverse_sum * part_s)) * turning;
  }
  if (!other.movable()) {
    const Vec3 rolls_down_nm = cross(of_body.position_m - point_m, body.mass_kg * body.gravity_factor * gravity_m_s2);
    needed_nm = needed_nm - rolls_down_nm + dot(rolls_down_nm, normal) * normal;
  }
  const double size_nm = length(needed_nm);
  if (!(size_nm > 0) || !std::isfinite(size_nm)) return;
  const Vec3 torque_nm = std::min(1.0, limit_nm / size_nm) * needed_nm;
  body.add_torque(torque_nm);
  if (other.movable()) other.add_torque(-1 * torque_nm);
}

}  // namespace ringdown::scene
