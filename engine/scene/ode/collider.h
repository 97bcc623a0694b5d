// A body or a static as ODE knows it. Callers must hold OdeLock. This header only names ODE's types, so that ODE's own
// headers stay in the .cpp files.
#pragma once

#include "engine/scene/contact_point.h"
#include "engine/scene/fixed_contacts.h"
#include "engine/scene/ode/shape.h"
#include "engine/scene/stillness.h"

#include <cstddef>
#include <memory>
#include <optional>

struct dxBody;
struct dxJoint;
struct dxWorld;

namespace ringdown::scene {

struct BodyDeleter {
  void operator()(dxBody* body) const;
};

struct JointDeleter {
  void operator()(dxJoint* joint) const;
};

// A body's place in Islands (islands.h), which alone changes it.
class IslandMember {
  friend class Islands;
  std::optional<std::size_t> number_;  // index in Islands::members(); none: the body is in no island
  double elasticity_ = 1;              // share of its contacts' restitution that acts in this part of the step
};

// Knows whether a body may fall asleep, and for how long it has stayed in place.
class Sleep {
 public:
  explicit Sleep(dxBody* body) : body_(body) {}  // null for a static, which never wakes

  [[nodiscard]] bool awake() const;
  void begin_step() { was_awake_ = awake(); }
  [[nodiscard]] bool was_awake() const { return was_awake_; }  // at the last begin_step()
  void fall();                                                 // the body rests until something touches it

  // Call when a joint of the scene holds the body. A body that a drive `keeps_moving` never sleeps.
  void join(bool keeps_moving);
  [[nodiscard]] bool joined() const { return joined_; }

  // Call after a step with the body's motion at its end. Returns for how long the body has stayed in place since the
  // last stir() or fall(); always 0 if a drive asks for a speed.
  double stays_for(const Motion& now, double outer_radius_m, double step_s);
  void stir() { stillness_.reset(); }
  [[nodiscard]] const Stillness& stillness() const { return stillness_; }
  void recall(const Stillness& stillness) { stillness_ = stillness; }

  // Allows the body to fall asleep without contacts that ODE knows of. ODE keeps bodies without joints awake, so that
  // none sleeps in the air.
  void allow(bool allowed);

 private:
  dxBody* const body_;
  bool joined_ = false, kept_moving_ = false;
  bool was_awake_ = false;
  Stillness stillness_;
  std::unique_ptr<dxJoint, JointDeleter> support_;  // a joint without effect; see allow()
  bool supported_ = false;
};

// The first three components of an ODE vector.
inline Vec3 to_vec3(const double* v) { return {v[0], v[1], v[2]}; }
inline void copy(Vec3 from, double* to) {
  to[0] = from.x;
  to[1] = from.y;
  to[2] = from.z;
}

// A body with its shape, or a static, which is a shape alone. Public members are constant, except for `island`,
// `sleep`, `owed_j` and a ghost that `shape` may get (shape.h).
class Collider {
 public:
  Collider(BodyId id, const StaticDescription& description, dxSpace* space);
  // A fixed body ignores velocity, gravity and contacts. `gravity_factor` multiplies the scene's gravity.
  Collider(BodyId id, const Solid& solid, const FrictionSurface& surface, bool fixed, double gravity_factor,
           dxWorld* world, dxSpace* space);

  const BodyId id;
  const FrictionSurface surface;
  const double half_thickness_m;    // of the thinnest part; infinite for a plane
  const double outer_radius_m = 0;  // about the centre of mass; this and the next five: of bodies only
  const double gravity_factor = 1;
  const bool round = false;  // a sphere
  const double mass_kg = 0;
  const Matrix3 inertia{}, inverse_inertia{};       // in the body's frame [kg m^2]
  const std::unique_ptr<dxBody, BodyDeleter> body;  // declared before the shape, which must be destroyed first
  OdeShape shape;
  IslandMember island;
  Sleep sleep{body.get()};
  double owed_j = 0;  // for lift()

  [[nodiscard]] bool movable() const;
  [[nodiscard]] bool awake() const { return sleep.awake(); }
  [[nodiscard]] Motion motion() const;  // for a static: rest at the origin
  void move(const Motion& motion);      // wakes the body

  // Prescribes the body's motion in the next step, at a constant velocity, unaffected by contacts.
  void drive(const Motion& motion);
  [[nodiscard]] bool driven() const { return told_.has_value(); }
  [[nodiscard]] bool driven_about() const;  // whether the prescribed motion is not rest
  // Places a driven body where it is after `done_s` of the step.
  void follow(double done_s);

  void add_torque(Vec3 torque_nm);           // for the next part of a step; world axes
  void add_force(Vec3 force_n, Vec3 arm_m);  // at a point `arm_m` from the centre of mass

  // Returns the body's motion at the end of the next part from gravity and the forces and torques added, without
  // contacts.
  [[nodiscard]] FreeBody without_contacts(Vec3 gravity_m_s2, double part_s) const;

  // Returns the body's motion after some time without force or torque, with energy and angular momentum unchanged.
  [[nodiscard]] Motion after(const Motion& motion, double time_s) const;

  // Turns the body for one part of a step: from the rotation `from`, which it had before the part, with its present
  // spin from the solver.
  void turn(const Rotation& from, double part_s);

  // Moves and turns the body. The spin turns with it, so that kinetic energy stays the same. The body owes the
  // potential energy that it gains.
  void lift(Vec3 way_m, Vec3 turn_rad, Vec3 gravity_m_s2);
  // Takes kinetic energy from the body for what it owes, at most nine tenths of what it has: velocity and spin shrink
  // in proportion. A body that does not touch anything has left what lifted it and owes nothing more.
  void pay_for_lifts(bool touches);

  // Scales down the spin and the velocity relative to `mean_m_s` to this share.
  void slow(double share, Vec3 mean_m_s);

  // All variables of a body that a step changes.
  struct State {
    Motion motion;
    Vec3 force_n, torque_nm;
    bool awake = false;
  };
  [[nodiscard]] State state() const;
  void restore(const State& state);

 private:
  void place(const Motion& motion);

  std::optional<Motion> told_;  // prescribed motion of a driven body
};

// Returns the body or static that a geometry belongs to.
Collider& collider_of(dxGeom* geom);

double kinetic_energy(const Collider& collider, const Motion& motion);  // [J]

}  // namespace ringdown::scene
