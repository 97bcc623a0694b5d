// What collides in ODE, and the questions asked of it. Callers hold OdeLock. ODE's types are only named here.
#pragma once

#include "engine/scene/ode_shape.h"
#include "engine/scene/simulation.h"

#include <memory>

struct dxBody;
struct dxSpace;

namespace ringdown::scene {

struct BodyDeleter {
  void operator()(dxBody* body) const;
};

// What Groups (ode_groups.h) notes of a body, and of the group it leads.
struct Item;
struct Account {
  Item* leader = nullptr;  // none: it is in no group
  double before_j = 0;
  Vec3 velocity_m_s;
  bool exempt = false;
  bool group_exempt = false;
  std::size_t group_contacts = 0;
  double group_before_j = 0, gained_j = 0;
};

// A body, or a static without one. A geometry's user data points here.
struct Item {
  BodyId id = 0;
  Surface surface;
  double mass_kg = 0;  // of a body, as is the next, in its frame [kg m^2]
  Matrix3 inertia{}, inverse_inertia{};
  double inner_radius_m = 0;  // of a ball inside it; infinite for a plane
  bool elastic = true;        // its contacts may bounce
  Account account;
  bool round = false;                         // a sphere
  bool was_awake = false;                     // before the step
  std::unique_ptr<dxBody, BodyDeleter> body;  // declared before the shape, which must go first
  OdeShape shape;

  [[nodiscard]] bool movable() const;
  [[nodiscard]] bool awake() const;
  [[nodiscard]] Motion motion() const;  // a static stays at the origin
  void move(const Motion& motion);      // wakes it
  void set_mass(const RigidMass& mass);
  void add_torque(Vec3 torque_nm);  // for the next part of a step; world axes

  // All that a step changes of a body.
  struct State {
    Motion motion;
    Vec3 force_n, torque_nm;
    bool awake = false;
  };
  [[nodiscard]] State state() const;
  void restore(const State& state);
};

// Of a ball about the centre of mass that the shape encloses; of a trimesh or a hull to the plane of its nearest face.
double inner_radius(const CollisionShape& shape);
double inner_radius(const StaticDescription& description);

// What looks ahead: a ray, and the box about all the rays of one body.
struct Feelers {
  Feelers();
  std::unique_ptr<dxGeom, GeomDeleter> ray, sweep;
};

// How far ahead a body may be moved at once, at most `rest_s`. One that moves by less than its own thickness cannot get
// lost in a plane, nor pass anything. A faster one looks ahead along its way, from its middle and from two rings about
// it as wide as the ball inside it: it may fly until it is in there by half of what is ahead on that line. What touches
// already may turn it back, so it is to be looked at again soon.
double free_flight(const Item& item, double rest_s, dxSpace* space, const Feelers& feelers);

}  // namespace ringdown::scene
