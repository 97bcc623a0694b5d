#include "engine/scene/ode_energy.h"

#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>

namespace ringdown::scene {
namespace {

// Less is a rounding error.
constexpr double kLeast_j = 1e-9;

double kinetic_energy(const Item& item, const Motion& motion) {
  const Vec3 spin = transpose(to_matrix(motion.rotation)) * motion.spin_rad_s;
  return 0.5 * (item.mass_kg * dot(motion.velocity_m_s, motion.velocity_m_s) + dot(spin, item.inertia * spin));
}

Item& leader_of(Item& item) {
  Item* leader = &item;
  while (leader->account.leader != leader) leader = leader->account.leader;
  item.account.leader = leader;
  return *leader;
}

}  // namespace

void EnergyLedger::open(std::map<BodyId, Item>& items) {
  pushed_m_s_.clear();
  for (auto& [id, item] : items) {
    item.account = {.leader = &item};
    if (!item.awake()) continue;
    const Motion motion = item.motion();
    item.account.before_j = kinetic_energy(item, motion);
    item.account.velocity_m_s = motion.velocity_m_s;
  }
}

void EnergyLedger::unite(Item& body, Item& other, double pushed_m_s) {
  pushed_m_s_.push_back(pushed_m_s);
  body.account.touches = true;
  if (other.movable()) leader_of(other).account.leader = &leader_of(body);
}

void EnergyLedger::exempt(Item& body) { body.account.exempt = true; }

bool EnergyLedger::close(std::map<BodyId, Item>& items, std::span<const Touch> touches, double part_s,
                         Vec3 gravity_m_s2, double tolerance) {
  for (auto& [id, item] : items) {
    if (!item.movable()) continue;
    Account& group = leader_of(item).account;
    group.group_exempt |= item.account.exempt;
    group.group_touches |= item.account.touches;
    group.group_before_j += item.account.before_j;
    const Motion motion = item.motion();
    const Vec3 mean_m_s = 0.5 * (item.account.velocity_m_s + motion.velocity_m_s);
    group.gained_j +=
        kinetic_energy(item, motion) - item.account.before_j - part_s * item.mass_kg * dot(gravity_m_s2, mean_m_s);
  }
  for (std::size_t k = 0; k < touches.size(); ++k) {
    Account& group = leader_of(items.at(touches[k].body)).account;
    if (pushed_m_s_[k] > 0) group.gained_j -= pushed_m_s_[k] * length(touches[k].impulse_ns);
  }
  bool any = false;
  for (auto& [id, item] : items) {
    if (!item.movable()) continue;
    const Account& group = leader_of(item).account;
    const bool gains = group.gained_j > tolerance * group.group_before_j + kLeast_j;
    item.elastic = !gains || group.group_exempt || !group.group_touches;
    any |= !item.elastic;
  }
  return any;
}

}  // namespace ringdown::scene
