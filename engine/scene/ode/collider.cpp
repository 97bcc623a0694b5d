#include "engine/scene/ode/collider.h"

#include "engine/scene/rotation.h"

#include <ode/ode.h>

#include <algorithm>
#include <cmath>

namespace ringdown::scene {
namespace {

// The largest share of its kinetic energy that a body pays at a time.
constexpr double kMaxPaid = 0.9;

// Maximum height for which a body owes energy. Trembling lifts bodies by hundredths of a millimetre; a body moved out
// of a deep overlap should fall freely soon.
constexpr double kMaxOwed_m = 2e-4;

void set_rotation(dxBody* body, const Rotation& r) {
  const dQuaternion q = {r.w, r.x, r.y, r.z};
  dBodySetQuaternion(body, q);
}

void set_velocity(dxBody* body, Vec3 velocity_m_s, Vec3 spin_rad_s) {
  dBodySetLinearVel(body, velocity_m_s.x, velocity_m_s.y, velocity_m_s.z);
  dBodySetAngularVel(body, spin_rad_s.x, spin_rad_s.y, spin_rad_s.z);
}

double thinnest(Vec3 size_m) { return std::min({size_m.x, size_m.y, size_m.z}); }

// Returns half of a shape's thickness: the radius of the largest ball about the centre of mass that is known to fit in
// (for a trimesh or a hull: up to the plane of the nearest face), or the ratio of volume to surface if that is larger,
// as for a bowl.
double half_thickness(const CollisionShape& shape) {
  if (shape.type == ShapeType::sphere) return shape.radius_m;
  if (shape.type == ShapeType::box) return 0.5 * thinnest(shape.size_m);
  double radius = dInfinity, surface = 0, volume = 0;
  for (const auto& [a, b, c] : shape.triangles) {
    const Vec3 area = cross(shape.points[b] - shape.points[a], shape.points[c] - shape.points[a]);
    if (!(length(area) > 0)) continue;
    radius = std::min(radius, std::abs(dot(area, shape.points[a])) / length(area));
    surface += length(area) / 2;
    volume += dot(area, shape.points[a]) / 6;
  }
  return surface > 0 ? std::max(radius, std::abs(volume) / surface) : 0;
}

}  // namespace

void BodyDeleter::operator()(dxBody* body) const { dBodyDestroy(body); }

void JointDeleter::operator()(dxJoint* joint) const { dJointDestroy(joint); }

Collider::Collider(BodyId own_id, const StaticDescription& description, dxSpace* space)
    : id(own_id),
      surface(description.surface),
      half_thickness_m(description.type == StaticType::plane ? dInfinity : 0.5 * thinnest(description.size_m)),
      shape(make_static(space, description)) {
  dGeomSetData(shape.geom.get(), this);
}

Collider::Collider(BodyId own_id, const Solid& solid, const FrictionSurface& own_surface, bool fixed, double factor,
                   dxWorld* world, dxSpace* space)
    : id(own_id),
      surface(own_surface),
      half_thickness_m(half_thickness(solid.shape)),
      outer_radius_m(outer_radius(solid.shape)),
      gravity_factor(factor),
      round(solid.shape.type == ShapeType::sphere),
      mass_kg(solid.mass.mass_kg),
      inertia(solid.mass.inertia_kg_m2),
      inverse_inertia(inverse(inertia)),
      body(dBodyCreate(world)),
      shape(make_shape(space, solid.shape)) {
  const Matrix3& i = inertia;
  dMass mass;
  dMassSetParameters(&mass, mass_kg, 0, 0, 0, i[0][0], i[1][1], i[2][2], i[0][1], i[0][2], i[1][2]);
  dBodySetMass(body.get(), &mass);
  if (fixed) dBodySetKinematic(body.get());
  dGeomSetData(shape.geom.get(), this);
  dGeomSetBody(shape.geom.get(), body.get());
  const Vec3 center = solid.shape.center_m;
  dGeomSetOffsetPosition(shape.geom.get(), center.x, center.y, center.z);
  dBodySetFiniteRotationMode(body.get(), 1);  // exact for a constant spin, however fast: spheres
  dBodySetGyroscopicMode(body.get(), 0);      // turn() does better
}

bool Collider::movable() const { return body && !dBodyIsKinematic(body.get()); }

bool Sleep::awake() const { return body_ && !dBodyIsKinematic(body_) && dBodyIsEnabled(body_); }

Motion Collider::motion() const {
  if (!body) return {};
  const dReal* q = dBodyGetQuaternion(body.get());
  return {to_vec3(dBodyGetPosition(body.get())), Rotation::from_wxyz(q[0], q[1], q[2], q[3]),
          to_vec3(dBodyGetLinearVel(body.get())), to_vec3(dBodyGetAngularVel(body.get()))};
}

// Sets pose and velocity, and wakes the body. What is fixed keeps its velocity. A rotation that the body has is not
// rounded again: heaps that go on with the same motion would soon differ.
void Collider::place(const Motion& motion) {
  owed_j = 0;
  dBodySetPosition(body.get(), motion.position_m.x, motion.position_m.y, motion.position_m.z);
  if (motion.rotation != this->motion().rotation) set_rotation(body.get(), normalized(motion.rotation));
  if (!movable()) return;
  set_velocity(body.get(), motion.velocity_m_s, motion.spin_rad_s);
  dBodyEnable(body.get());
}

void Collider::move(const Motion& motion) {
  place(motion);
  sleep.stir();
}

void Collider::drive(const Motion& motion) {
  if (!driven()) dBodySetAutoDisableFlag(body.get(), 0);
  told_ = motion;
  place(motion);
  set_velocity(body.get(), motion.velocity_m_s, motion.spin_rad_s);
}

bool Collider::driven_about() const {
  return driven() && (told_->velocity_m_s != Vec3{} || told_->spin_rad_s != Vec3{});
}

void Collider::follow(double done_s) {
  if (!driven()) return;
  Motion now = *told_;
  now.position_m = now.position_m + done_s * now.velocity_m_s;
  now.rotation = normalized(from_rotation_vector(done_s * now.spin_rad_s) * now.rotation);
  place(now);
  set_velocity(body.get(), now.velocity_m_s, now.spin_rad_s);
}

void Sleep::join(bool keeps_moving) {
  joined_ = true;
  if (!keeps_moving) return;
  kept_moving_ = true;
  dBodySetAutoDisableFlag(body_, 0);
}

double Sleep::stays_for(const Motion& now, double outer_radius_m, double step_s) {
  stillness_.step({now.position_m, now.rotation}, outer_radius_m, step_s);
  return kept_moving_ ? 0 : stillness_.still_s();
}

void Collider::add_torque(Vec3 torque_nm) { dBodyAddTorque(body.get(), torque_nm.x, torque_nm.y, torque_nm.z); }

void Collider::add_force(Vec3 force_n, Vec3 arm_m) {
  dBodyAddForce(body.get(), force_n.x, force_n.y, force_n.z);
  add_torque(cross(arm_m, force_n));
}

void Sleep::fall() {
  set_velocity(body_, {}, {});
  dBodyDisable(body_);
  stir();
}

void Sleep::allow(bool allowed) {
  if (allowed == supported_) return;
  supported_ = allowed;
  if (!support_) support_.reset(dJointCreateNull(dBodyGetWorld(body_), nullptr));
  dJointAttach(support_.get(), allowed ? body_ : nullptr, nullptr);
}

FreeBody Collider::without_contacts(Vec3 gravity_m_s2, double part_s) const {
  const Motion now = motion();
  const Matrix3 frame = to_matrix(now.rotation);
  FreeBody free{1 / mass_kg, product(product(frame, inverse_inertia), transpose(frame)), {}, {}};
  const Vec3 force_n = to_vec3(dBodyGetForce(body.get())), torque_nm = to_vec3(dBodyGetTorque(body.get()));
  free.velocity_m_s = now.velocity_m_s + part_s * (gravity_m_s2 + free.inverse_mass * force_n);
  free.spin_rad_s = now.spin_rad_s + part_s * (free.inverse_inertia * torque_nm);
  return free;
}

// Euler's equations for the angular momentum in the body's frame, dL/dt = L x w with w = I^-1 L, by the implicit
// midpoint rule. The rule keeps quadratic invariants, so the energy L.w/2 and the length of L are constant to rounding.
// It turns L by the Cayley transform of the mean spin, so that the body, turned the opposite way, keeps its angular
// momentum in the world. The rule's step is stretched to 2 tan(w h/2)/w, which makes a steady spin exact. ODE would
// hold the spin constant in the world while the body turns, and its energy would drift.
Motion Collider::after(const Motion& motion, double time_s) const {
  constexpr double kMaxTurn = 0.2;  // rad in one application of the rule
  constexpr int kMaxIterations = 20;
  Motion end = motion;
  end.position_m = motion.position_m + time_s * motion.velocity_m_s;
  Vec3 momentum = inertia * (transpose(to_matrix(motion.rotation)) * motion.spin_rad_s);
  const double spin = length(inverse_inertia * momentum);
  if (!(spin > 0)) return end;
  const int times = 1 + static_cast<int>(spin * time_s / kMaxTurn);
  const double h = 2 * std::tan(0.5 * spin * time_s / times) / spin;
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
    end.rotation = normalized(end.rotation * Rotation::from_xyzw(half.x, half.y, half.z, 1));
  }
  end.spin_rad_s = to_matrix(end.rotation) * (inverse_inertia * momentum);
  return end;
}

void Collider::turn(const Rotation& from, double part_s) {
  constexpr double kMinTurn_rad = 1e-13;  // below that, ODE's own turn is as good
  if (!(length(to_vec3(dBodyGetAngularVel(body.get()))) * part_s > kMinTurn_rad)) return;
  Motion start = motion();
  start.rotation = from;
  const Motion end = after(start, part_s);
  set_rotation(body.get(), end.rotation);
  dBodySetAngularVel(body.get(), end.spin_rad_s.x, end.spin_rad_s.y, end.spin_rad_s.z);
}

void Collider::lift(Vec3 way_m, Vec3 turn_rad, Vec3 gravity_m_s2) {
  const Motion now = motion();
  const Vec3 at = now.position_m + way_m;
  dBodySetPosition(body.get(), at.x, at.y, at.z);
  if (const double angle_rad = length(turn_rad); angle_rad > 0) {
    const Rotation turn = about(turn_rad, angle_rad);
    const Vec3 spin = to_matrix(turn) * now.spin_rad_s;
    set_rotation(body.get(), normalized(turn * now.rotation));
    dBodySetAngularVel(body.get(), spin.x, spin.y, spin.z);
  }
  const double weight_n = mass_kg * std::abs(gravity_factor) * length(gravity_m_s2);
  const double gained_j = -mass_kg * gravity_factor * dot(gravity_m_s2, way_m);
  owed_j = std::clamp(owed_j + gained_j, 0.0, kMaxOwed_m * weight_n);
}

void Collider::pay_for_lifts(bool touches) {
  if (!touches) owed_j = 0;
  if (owed_j <= 0) return;
  const double kinetic_j = kinetic_energy(*this, motion());
  const double paid_j = std::min(owed_j, kMaxPaid * kinetic_j);
  if (!(paid_j > 0)) return;
  owed_j -= paid_j;
  slow(std::sqrt(1 - paid_j / kinetic_j), {});
}

void Collider::slow(double share, Vec3 mean_m_s) {
  const Motion now = motion();
  set_velocity(body.get(), mean_m_s + share * (now.velocity_m_s - mean_m_s), share * now.spin_rad_s);
}

Collider::State Collider::state() const {
  return {motion(), to_vec3(dBodyGetForce(body.get())), to_vec3(dBodyGetTorque(body.get())), awake()};
}

void Collider::restore(const State& state) {
  place(state.motion);
  dBodySetForce(body.get(), state.force_n.x, state.force_n.y, state.force_n.z);
  dBodySetTorque(body.get(), state.torque_nm.x, state.torque_nm.y, state.torque_nm.z);
  if (!state.awake) dBodyDisable(body.get());
}

Collider& collider_of(dxGeom* geom) { return *static_cast<Collider*>(dGeomGetData(geom)); }

double kinetic_energy(const Collider& collider, const Motion& motion) {
  const Vec3 spin = transpose(to_matrix(motion.rotation)) * motion.spin_rad_s;
  return 0.5 * (collider.mass_kg * dot(motion.velocity_m_s, motion.velocity_m_s) + dot(spin, collider.inertia * spin));
}

}  // namespace ringdown::scene
