#include "engine/scene/ode_collider.h"

#include "engine/scene/rotation.h"

#include <ode/ode.h>

#include <algorithm>
#include <cmath>

namespace ringdown::scene {
namespace {

Vec3 to_vec3(const dReal* v) { return {v[0], v[1], v[2]}; }

}  // namespace

void BodyDeleter::operator()(dxBody* body) const { dBodyDestroy(body); }

bool Collider::movable() const { return body && !dBodyIsKinematic(body.get()); }

bool Collider::awake() const { return movable() && dBodyIsEnabled(body.get()); }

Motion Collider::motion() const {
  if (!body) return {};
  const dReal* q = dBodyGetQuaternion(body.get());
  return {to_vec3(dBodyGetPosition(body.get())),
          {q[1], q[2], q[3], q[0]},
          to_vec3(dBodyGetLinearVel(body.get())),
          to_vec3(dBodyGetAngularVel(body.get()))};
}

void Collider::move(const Motion& motion) {
  const Rotation r = normalized(motion.rotation);
  const dQuaternion q = {r.w, r.x, r.y, r.z};
  dBodySetPosition(body.get(), motion.position_m.x, motion.position_m.y, motion.position_m.z);
  dBodySetQuaternion(body.get(), q);
  if (!movable()) return;
  dBodySetLinearVel(body.get(), motion.velocity_m_s.x, motion.velocity_m_s.y, motion.velocity_m_s.z);
  dBodySetAngularVel(body.get(), motion.spin_rad_s.x, motion.spin_rad_s.y, motion.spin_rad_s.z);
  dBodyEnable(body.get());
}

void Collider::set_mass(const RigidMass& rigid) {
  const Matrix3& i = rigid.inertia_kg_m2;
  dMass mass;
  dMassSetParameters(&mass, rigid.mass_kg, 0, 0, 0, i[0][0], i[1][1], i[2][2], i[0][1], i[0][2], i[1][2]);
  dBodySetMass(body.get(), &mass);
  mass_kg = rigid.mass_kg;
  inertia = i;
  inverse_inertia = inverse(i);
}

void Collider::add_torque(Vec3 torque_nm) { dBodyAddTorque(body.get(), torque_nm.x, torque_nm.y, torque_nm.z); }

// Euler's equations for the angular momentum in the body's frame, dL/dt = L x w with w = I^-1 L, by the implicit
// midpoint rule. The rule keeps quadratic invariants, so energy L.w/2 and length of L stay what they are, to rounding;
// and it turns L by the Cayley transform of the mean spin, so that the body, turned the opposite way, keeps its angular
// momentum in the world. The rule's step is stretched to 2 tan(w h/2)/w, which makes a steady spin exact. ODE would
// hold the spin constant in the world while the body turns, and its energy would drift.
void Collider::turn(const Rotation& from, double part_s) {
  constexpr double kMaxTurn = 0.2;  // rad in one application of the rule
  constexpr int kMaxIterations = 20;
  const Matrix3 frame = to_matrix(from);
  Vec3 momentum = inertia * (transpose(frame) * motion().spin_rad_s);
  Rotation rotation = from;
  const double spin = length(inverse_inertia * momentum);
  if (!(spin > 0)) return;
  const int times = 1 + static_cast<int>(spin * part_s / kMaxTurn);
  const double h = 2 * std::tan(0.5 * spin * part_s / times) / spin;
  for (int k = 0; k < times; ++k) {
    Vec3 next = momentum, mean_spin;
    for (int i = 0; i < kMaxIterations; ++i) {
      const Vec3 mean = 0.5 * (momentum + next);
      mean_spin = inverse_inertia * mean;
      const Vec3 better = momentum + h * cross(mean, mean_spin);
      const bool settled = length(better - next) <= 1e-15 * length(momentum);
      next = better;
      if (settled) break;
    }
    momentum = next;
    const Vec3 half = 0.5 * h * mean_spin;
    rotation = normalized(rotation * Rotation{half.x, half.y, half.z, 1});
  }
  const dQuaternion q = {rotation.w, rotation.x, rotation.y, rotation.z};
  const Vec3 turned = to_matrix(rotation) * (inverse_inertia * momentum);
  dBodySetQuaternion(body.get(), q);
  dBodySetAngularVel(body.get(), turned.x, turned.y, turned.z);
}

Collider::State Collider::state() const {
  return {motion(), to_vec3(dBodyGetForce(body.get())), to_vec3(dBodyGetTorque(body.get())), awake()};
}

void Collider::restore(const State& state) {
  move(state.motion);
  dBodySetForce(body.get(), state.force_n.x, state.force_n.y, state.force_n.z);
  dBodySetTorque(body.get(), state.torque_nm.x, state.torque_nm.y, state.torque_nm.z);
  if (!state.awake) dBodyDisable(body.get());
}

double inner_radius(const CollisionShape& shape) {
  if (shape.type == ShapeType::sphere) return shape.radius_m;
  if (shape.type == ShapeType::box) return 0.5 * std::min({shape.size_m.x, shape.size_m.y, shape.size_m.z});
  double radius = dInfinity;
  for (const auto& [a, b, c] : shape.triangles) {
    const Vec3 area = cross(shape.points[b] - shape.points[a], shape.points[c] - shape.points[a]);
    if (length(area) > 0) radius = std::min(radius, std::abs(dot(area, shape.points[a])) / length(area));
  }
  return std::isfinite(radius) ? radius : 0;
}

double inner_radius(const StaticDescription& description) {
  const Vec3 size = description.size_m;
  return description.type == StaticType::plane ? dInfinity : 0.5 * std::min({size.x, size.y, size.z});
}

}  // namespace ringdown::scene
