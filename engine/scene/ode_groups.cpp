#include "engine/scene/ode_groups.h"

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

void Groups::enter(Item& item) {
  if (item.account.leader) return;
  const Motion motion = item.motion();
  item.account = {.leader = &item, .before_j = kinetic_energy(item, motion), .velocity_m_s = motion.velocity_m_s};
  members_.push_back(&item);
}

void Groups::lead(Item& body, Item& other) {
  enter(body);
  enter(other);
  leader_of(other).account.leader = &leader_of(body);
}

void Groups::open(std::map<BodyId, Item>& items) {
  members_.clear();
  ties_.clear();
  for (auto& [id, item] : items) {
    item.account.leader = nullptr;
    if (item.awake()) enter(item);
  }
}

void Groups::unite(Item& body, Item& other, double pushed_m_s) {
  enter(body);
  ties_.push_back({&body, pushed_m_s});
  if (other.movable()) lead(body, other);
}

void Groups::join(Item& body, Item* other) {
  if (!body.account.leader && !(other && other->account.leader)) return;
  if (other && body.movable() && other->movable()) lead(body, *other);
  body.account.exempt = true;
  if (other) other->account.exempt = true;
}

std::size_t Groups::most_contacts() const {
  std::size_t most = 0;
  for (const Tie& tie : ties_) most = std::max(most, ++leader_of(*tie.body).account.group_contacts);
  return most;
}

bool Groups::gain(std::span<const Touch> touches, double part_s, Vec3 gravity_m_s2, double tolerance) {
  for (Item* item : members_) {
    Account& group = leader_of(*item).account;
    group.group_exempt |= item->account.exempt;
    group.group_before_j += item->account.before_j;
    const Motion motion = item->motion();
    const Vec3 mean_m_s = 0.5 * (item->account.velocity_m_s + motion.velocity_m_s);
    group.gained_j +=
        kinetic_energy(*item, motion) - item->account.before_j - part_s * item->mass_kg * dot(gravity_m_s2, mean_m_s);
  }
  for (std::size_t k = 0; k < ties_.size(); ++k) {
    if (ties_[k].pushed_m_s == 0) continue;
    leader_of(*ties_[k].body).account.gained_j -= ties_[k].pushed_m_s * length(touches[k].impulse_ns);
  }
  bool any = false;
  for (Item* item : members_) {
    const Account& group = leader_of(*item).account;
    const bool gains = group.gained_j > tolerance * group.group_before_j + kLeast_j;
    item->elastic = !gains || group.group_exempt || group.group_contacts == 0;
    any |= !item->elastic;
  }
  return any;
}

}  // namespace ringdown::scene
