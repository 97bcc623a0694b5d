#include "engine/scene/ode/islands.h"

#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::scene {
namespace {

// Energy that an island may gain in one part, as a share of its kinetic energy: the error of the solvers.
constexpr double kGain = 1e-9, kGainByIteration = 1e-2;

// A smaller gain is a rounding error.
constexpr double kMinGain_j = 1e-9;

constexpr double kMargin = 1.2;

}  // namespace

struct Islands::Sum {
  bool exempt = false, held = false;
  double before_j = 0, now_j = 0, gained_j = 0, bounced_j = 0;
  double mass_kg = 0;
  Vec3 momentum_ns;

  [[nodiscard]] bool gains(double tolerance) const {
    return gained_j > tolerance * before_j + kMinGain_j && !exempt && bounced_j > 0;
  }
};

// Islands are a union-find structure: every node points to another of its island, up to the root. The smaller island
// joins the larger one, so that ways to the root stay short.
std::size_t Islands::root_of(std::size_t number) const {
  while (nodes_[number].parent != number) number = nodes_[number].parent;
  return number;
}

bool Islands::is_alone(const Collider& member) const {
  const Node& node = nodes_[*member.island.number_];
  return !node.has_others && !node.exempt;
}

std::size_t Islands::enter(Collider& body) {
  if (body.island.number_) return *body.island.number_;
  const std::size_t number = members_.size();
  const Motion motion = body.motion();
  members_.push_back(&body);
  nodes_.push_back({number, kinetic_energy(body, motion), motion.velocity_m_s});
  body.island.number_ = number;
  return number;
}

void Islands::merge(std::size_t body, std::size_t other) {
  nodes_[body].has_others = nodes_[other].has_others = true;
  std::size_t root = root_of(body), joins = root_of(other);
  if (root == joins) return;
  if (nodes_[root].size < nodes_[joins].size) std::swap(root, joins);
  nodes_[joins].parent = root;
  nodes_[root].size += nodes_[joins].size;
  nodes_[root].contacts += nodes_[joins].contacts;
}

void Islands::open(std::span<Collider* const> colliders) {
  members_.clear();
  nodes_.clear();
  links_.clear();
  for (Collider* collider : colliders) {
    collider->island.number_.reset();
    if (collider->awake()) enter(*collider);
  }
}

void Islands::unite(Collider& body, Collider& other) {
  const std::size_t number = enter(body);
  links_.push_back({number});
  if (other.movable()) merge(number, enter(other));
  nodes_[number].held |= !other.movable();
  if (other.driven()) nodes_[number].exempt = true;
  ++nodes_[root_of(number)].contacts;
}

void Islands::set_speeds(std::size_t contact, double pushed_m_s, bool bounces) {
  links_[contact].pushed_m_s = pushed_m_s;
  links_[contact].bounces = bounces;
}

void Islands::join(Collider& body, Collider* other) {
  if (!body.island.number_ && !(other && other->island.number_)) return;
  if (other && body.movable() && other->movable()) merge(enter(body), enter(*other));
  for (const Collider* one : {&body, other}) {
    if (one && one->island.number_) nodes_[*one->island.number_].exempt = true;
  }
}

void Islands::settle_all() {
  for (Node& node : nodes_) node.settled = true;
}

void Islands::unsettle_all() {
  for (Node& node : nodes_) node.settled = false;
}

std::size_t Islands::max_contacts() const {
  return nodes_.empty() ? 0 : std::ranges::max_element(nodes_, {}, &Node::contacts)->contacts;
}

// For each island, the energy gained is the change of its bodies' kinetic energy, less the work of gravity along their
// mean velocities. The sums of an island stand at the number of its root.
std::vector<Islands::Sum> Islands::weigh(std::span<const ContactPoint> points, double part_s, Vec3 gravity_m_s2) const {
  std::vector<Sum> sums(nodes_.size());
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const Collider& body = *members_[k];
    const Node& node = nodes_[k];
    Sum& sum = sums[root_of(k)];
    sum.exempt |= node.exempt;
    sum.held |= node.held;
    sum.before_j += node.before_j;
    const Motion motion = body.motion();
    const double now_j = kinetic_energy(body, motion);
    const Vec3 mean_m_s = 0.5 * (node.velocity_m_s + motion.velocity_m_s);
    sum.now_j += now_j;
    sum.mass_kg += body.mass_kg;
    sum.momentum_ns = sum.momentum_ns + body.mass_kg * motion.velocity_m_s;
    sum.gained_j += now_j - node.before_j - part_s * body.mass_kg * body.gravity_factor * dot(gravity_m_s2, mean_m_s);
  }
  for (std::size_t k = 0; k < links_.size(); ++k) {
    if (!links_[k].bounces) continue;
    const double normal_ns = dot(points[k].impulse_ns, points[k].normal);
    sums[root_of(links_[k].body)].bounced_j += 0.5 * points[k].approach_m_s * std::max(normal_ns, 0.0);
  }
  return sums;
}

// A gain is removed by lowering restitution. A mass M that arrives with speed v receives the impulse J = M v (1 + e)
// and keeps the energy M v^2 e^2 / 2, which changes by M v^2 e per unit of e: at e = 1 that is J v / 2. So e is lowered
// by the gain over the sum of J v / 2, and by kMargin more, because contacts act on each other. If this was not enough,
// the next solution shows it. If nothing bounces, nothing can be removed.
bool Islands::gained_energy(std::span<const ContactPoint> points, double part_s, Vec3 gravity_m_s2, bool exact,
                            bool last) {
  if (std::ranges::none_of(links_, &Link::bounces)) return false;
  std::vector<Sum> sums = weigh(points, part_s, gravity_m_s2);
  for (std::size_t k = 0; k < links_.size() && !exact; ++k) {
    sums[root_of(links_[k].body)].gained_j -= links_[k].pushed_m_s * length(points[k].impulse_ns);
  }
  bool any = false;
  for (std::size_t k = 0; k < members_.size(); ++k) {
    const Sum& sum = sums[root_of(k)];
    if (!sum.gains(exact ? kGain : kGainByIteration)) continue;
    nodes_[root_of(k)].settled = false;
    members_[k]->island.elasticity_ *= last ? 0 : std::max(1 - kMargin * sum.gained_j / sum.bounced_j, 0.0);
    any = true;
  }
  return any;
}

// Scales down all velocities of the island, relative to its mean velocity unless something holds it. The island keeps
// its momentum, and contacts that separate continue to separate.
void Islands::end_part(std::span<const ContactPoint> points, double part_s, Vec3 gravity_m_s2) {
  for (Collider* body : members_) body->island.elasticity_ = 1;
  if (std::ranges::none_of(links_, &Link::bounces)) return;
  const std::vector<Sum> sums = weigh(points, part_s, gravity_m_s2);
  for (std::size_t k = 0; k < members_.size(); ++k) {
    const Sum& sum = sums[root_of(k)];
    if (!sum.gains(kGain)) continue;
    const Vec3 mean_m_s = sum.held ? Vec3{} : (1 / sum.mass_kg) * sum.momentum_ns;
    const double inner_j = sum.now_j - 0.5 * sum.mass_kg * dot(mean_m_s, mean_m_s);
    members_[k]->slow(std::sqrt(std::max(1 - sum.gained_j / inner_j, 0.0)), mean_m_s);
  }
}

}  // namespace ringdown::scene
