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

// The first three components of an ODE vector.
inline Vec3 to_vec3(const double* v) { return {v[0], v[1], v[2]}; }

// A body with its shape, or a static, which is a shape alone. The user data of an ODE geometry points to its Collider.
struct Collider {
  BodyId id = 0;
  FrictionSurface surface;
  double mass_kg = 0;                    // mass and the two inertias: of bodies only
  Matrix3 inertia{}, inverse_inertia{};  // in the body's frame [kg m^2]
  double half_thickness_m = 0;           // see half_thickness(); infinite for a plane
  double outer_radius_m = 0;             // see outer_radius(); unused for statics
  double gravity_factor = 1;             // multiplies the scene's gravity; bodies only
  bool round = false;                    // a sphere
  bool joined = false;                   // whether a joint of the scene holds the body
  bool kept_moving = false;              // whether a drive asks for a speed; such a body does not sleep
  bool driven = false;                   // whether the body follows a prescribed motion, unaffected by contacts
  Motion told;                           // prescribed motion of a driven body in this part of the step
  bool was_awake = false;                // whether the body was awake before the step
  IslandMember island;
  Stillness stillness;
  double lifted_j = 0;                        // energy still to be taken from the body because overlap.h lifted it
  std::unique_ptr<dxBody, BodyDeleter> body;  // declared before the shape, which must be destroyed first
  OdeShape shape;
  std::unique_ptr<dxJoint, JointDeleter> support;  // a joint without effect; see let_sleep()
  bool supported = false;

  [[nodiscard]] bool movable() const;
  [[nodiscard]] bool awake() const;
  [[nodiscard]] Motion motion() const;  // for a static: rest at the origin
  void move(const Motion& motion);      // wakes the body
  void drive(const Motion& motion);     // sets the motion of a driven body
  void set_mass(const RigidMass& mass);
  void add_torque(Vec3 torque_nm);           // for the next part of a step; world axes
  void add_force(Vec3 force_n, Vec3 arm_m);  // at a point `arm_m` from the centre of mass

  void fall_asleep();  // the body rests until something touches it

  // Allows the body to fall asleep without contacts that ODE knows of. ODE keeps bodies without joints awake, so that
  // none sleeps in the air.
  void let_sleep(bool allowed);

  // Returns the body's motion at the end of the next part from gravity and the forces and torques added, without
  // contacts.
  [[nodiscard]] FreeBody without_contacts(Vec3 gravity_m_s2, double part_s) const;

  // Returns the body's motion after some time without force or torque, with energy and angular momentum unchanged.
  [[nodiscard]] Motion after(const Motion& motion, double time_s) const;

  // Turns the body for one part of a step: from the rotation `from`, which it had before the part, with its present
  // spin from the solver.
  void turn(const Rotation& from, double part_s);

  // Moves and turns the body. The spin turns with it, so that kinetic energy stays the same.
  void shift(Vec3 way_m, Vec3 turn_rad);

  // Scales down the spin and the velocity relative to `mean_m_s` to this share.
  void slow(double share, Vec3 mean_m_s);

  // Takes kinetic energy from the body to pay for `lifted_j`, at most nine tenths of what the body has: velocity and
  // spin shrink in proportion.
  void pay_for_lifts();

  // All variables of a body that a step changes.
  struct State {
    Motion motion;
    Vec3 force_n, torque_nm;
    bool awake = false;
  };
  [[nodiscard]] State state() const;
  void restore(const State& state);
};

// Returns half of a shape's thickness: the radius of the largest ball about the centre of mass that is known to fit in
// (for a trimesh or a hull: up to the plane of the nearest face), or the ratio of volume to surface if that is larger,
// as for a bowl.
double half_thickness(const CollisionShape& shape);
double half_thickness(const StaticDescription& description);

// Returns the radius of the smallest ball about the centre of mass that holds the shape.
double outer_radius(const CollisionShape& shape);

}  // namespace ringdown::scene
