#include "engine/scene/ode/islands.h"

#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>

namespace ringdown::scene {
namespace {

// A smaller gain is a rounding error.
constexpr double kMinGain_j = 1e-9;

constexpr double kMargin = 1.2;

double kinetic_energy(const Collider& collider, const Motion& motion) {
  const Vec3 spin = transpose(to_matrix(motion.rotation)) * motion.spin_rad_s;
  return 0.5 * (collider.mass_kg * dot(motion.velocity_m_s, motion.velocity_m_s) + dot(spin, collider.inertia * spin));
}

// Islands are a union-find structure: every body points to another of its island, up to the root.
Collider& root_of(Collider& collider) {
  Collider* root = &collider;
  while (root->island.parent != root) root = root->island.parent;
  collider.island.parent = root;
  return *root;
}

}  // namespace

Collider& island_of(Collider& body) { return body.island.parent ? root_of(body) : body; }

void Islands::enter(Collider& body) {
  if (body.island.parent) return;
  const Motion motion = body.motion();
  body.island = {.parent = &body, .before_j = kinetic_energy(body, motion), .velocity_m_s = motion.velocity_m_s};
  members_.push_back(&body);
}

void Islands::merge(Collider& body, Collider& other) {
  enter(body);
  enter(other);
  body.island.has_others = other.island.has_others = true;
  root_of(other).island.parent = &root_of(body);
}

void Islands::open(std::span<Collider* const> colliders) {
  members_.clear();
  links_.clear();
  for (Collider* collider : colliders) {
    collider->island.parent = nullptr;
    if (collider->awake()) enter(*collider);
  }
}

void Islands::unite(Collider& body, Collider& other, double pushed_m_s, bool bounces) {
  enter(body);
  links_.push_back({&body, pushed_m_s, bounces});
  if (other.movable()) merge(body, other);
  body.island.held |= !other.movable();
  if (other.driven) body.island.exempt = true;
}

void Islands::join(Collider& body, Collider* other) {
  if (!body.island.parent && !(other && other->island.parent)) return;
  if (other && body.movable() && other->movable()) merge(body, *other);
  body.island.exempt = true;
  if (other) other->island.exempt = true;
}

std::size_t Islands::max_contacts() const {
  std::size_t most = 0;
  for (const Link& link : links_) most = std::max(most, ++root_of(*link.body).island.contacts);
  return most;
}

// For each island, the energy gained is the change of its bodies' kinetic energy, less the work of gravity along their
// mean velocities.
void Islands::weigh(std::span<const ContactPoint> points, double part_s, Vec3 gravity_m_s2) {
  for (Collider* body : members_) {
    IslandState& island = body->island;
    island.any_exempt = island.any_held = false;
    island.total_before_j = island.total_j = island.gained_j = island.bounced_j = island.mass_kg = 0;
    island.momentum_ns = {};
  }
  for (Collider* body : members_) {
    IslandState& island = root_of(*body).island;
    island.any_exempt |= body->island.exempt;
    island.any_held |= body->island.held;
    island.total_before_j += body->island.before_j;
    const Motion motion = body->motion();
    const double now_j = kinetic_energy(*body, motion);
    const Vec3 mean_m_s = 0.5 * (body->island.velocity_m_s + motion.velocity_m_s);
    island.total_j += now_j;
    island.mass_kg += body->mass_kg;
    island.momentum_ns = island.momentum_ns + body->mass_kg * motion.velocity_m_s;
    island.gained_j +=
        now_j - body->island.before_j - part_s * body->mass_kg * body->gravity_factor * dot(gravity_m_s2, mean_m_s);
  }
  for (std::size_t k = 0; k < links_.size(); ++k) {
    if (!links_[k].bounces) continue;
    const double normal_ns = dot(points[k].impulse_ns, points[k].normal);
    root_of(*links_[k].body).island.bounced_j += 0.5 * points[k].approach_m_s * std::max(normal_ns, 0.0);
  }
}

// A gain is removed by lowering restitution. A mass M that arrives with speed v receives the impulse J = M v (1 + e)
// and keeps the energy M v^2 e^2 / 2, which changes by M v^2 e per unit of e: at e = 1 that is J v / 2. So e is lowered
// by the gain over the sum of J v / 2, and by kMargin more, because contacts act on each other. If this was not enough,
// the next solution shows it. If nothing bounces, nothing can be removed.
bool Islands::gained_energy(std::span<const ContactPoint> points, double part_s, Vec3 gravity_m_s2,
                            const Check& check) {
  if (std::ranges::none_of(links_, &Link::bounces)) return false;
  weigh(points, part_s, gravity_m_s2);
  for (std::size_t k = 0; k < links_.size() && check.pushed; ++k) {
    root_of(*links_[k].body).island.gained_j -= links_[k].pushed_m_s * length(points[k].impulse_ns);
  }
  bool any = false;
  for (Collider* body : members_) {
    const IslandState& island = root_of(*body).island;
    if (!gains(island, check.tolerance)) continue;
    body->elasticity *= check.last ? 0 : std::max(1 - kMargin * island.gained_j / island.bounced_j, 0.0);
    any = true;
  }
  return any;
}

bool Islands::gains(const IslandState& island, double tolerance) {
  return island.gained_j > tolerance * island.total_before_j + kMinGain_j && !island.any_exempt && island.bounced_j > 0;
}

// Scales down all velocities of the island, relative to its mean velocity unless something holds it. The island keeps
// its momentum, and contacts that separate continue to separate.
void Islands::take_gains(std::span<const ContactPoint> points, double part_s, Vec3 gravity_m_s2, double tolerance) {
  if (std::ranges::none_of(links_, &Link::bounces)) return;
  weigh(points, part_s, gravity_m_s2);
  for (Collider* body : members_) {
    const IslandState& island = root_of(*body).island;
    if (!gains(island, tolerance) || !body->movable()) continue;
    const Vec3 mean_m_s = island.any_held ? Vec3{} : (1 / island.mass_kg) * island.momentum_ns;
    const double inner_j = island.total_j - 0.5 * island.mass_kg * dot(mean_m_s, mean_m_s);
    body->slow(std::sqrt(std::max(1 - island.gained_j / inner_j, 0.0)), mean_m_s);
  }
}

}  // namespace ringdown::scene
