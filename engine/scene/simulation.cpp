#include "engine/scene/simulation.h"

#include "engine/scene/ode_shape.h"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <map>
#include <mutex>
#include <vector>

namespace ringdown::scene {
namespace {

// Held during every call into ODE. The first one on a thread gives ODE its data for that thread.
class OdeLock {
 public:
  OdeLock() : lock_(mutex()) {
    static const int ready = dInitODE2(0);
    thread_local const int allocated = dAllocateODEDataForThread(dAllocateMaskAll);
    assert(ready && allocated);
    static_cast<void>(ready), static_cast<void>(allocated);
  }

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  std::lock_guard<std::mutex> lock_;
};

struct WorldDeleter {
  void operator()(dxWorld* world) const { dWorldDestroy(world); }
};
struct SpaceDeleter {
  void operator()(dxSpace* space) const { dSpaceDestroy(space); }
};
struct BodyDeleter {
  void operator()(dxBody* body) const { dBodyDestroy(body); }
};
struct JointsDeleter {
  void operator()(dxJointGroup* joints) const { dJointGroupDestroy(joints); }
};

// A mesh touching a plane gives a contact per vertex: enough of them to choose a good few.
constexpr int kMostContactsFound = 256;

// A body that has hardly moved for this long sleeps until something touches it.
constexpr double kSleepAfter_s = 0.5, kSleepSpeed_m_s = 0.005, kSleepSpin_rad_s = 0.01;

// Pushing overlapping bodies apart faster than this would make a bounce, and energy, out of nothing.
constexpr double kFastestCorrection_m_s = 0.02;

Vec3 to_vec3(const dReal* v) { return {v[0], v[1], v[2]}; }

// What collides: a body, or a static without one. A geometry's user data points here.
struct Item {
  BodyId id = 0;
  Surface surface;
  std::unique_ptr<dxBody, BodyDeleter> body;  // declared before the shape, which must go first
  OdeShape shape;

  [[nodiscard]] bool movable() const { return body && !dBodyIsKinematic(body.get()); }
  [[nodiscard]] bool awake() const { return movable() && dBodyIsEnabled(body.get()); }
  [[nodiscard]] Vec3 velocity_at(const dReal* point) const {
    if (!body) return {};
    dVector3 velocity;
    dBodyGetPointVel(body.get(), point[0], point[1], point[2], velocity);
    return to_vec3(velocity);
  }
};

// Moves the deepest contact to the front, then each time the one farthest from those already chosen.
std::size_t choose_contacts(std::span<dContactGeom> found) {
  if (found.size() <= kMostContactsPerPair) return found.size();
  std::ranges::iter_swap(found.begin(), std::ranges::max_element(found, {}, &dContactGeom::depth));
  for (std::size_t chosen = 1; chosen < kMostContactsPerPair; ++chosen) {
    const auto distance = [&](const dContactGeom& candidate) {
      double nearest = dInfinity;
      for (const dContactGeom& taken : found.first(chosen)) {
        nearest = std::min(nearest, length(to_vec3(candidate.pos) - to_vec3(taken.pos)));
      }
      return nearest;
    };
    std::ranges::iter_swap(found.begin() + static_cast<std::ptrdiff_t>(chosen),
                           std::ranges::max_element(found.subspan(chosen), {}, distance));
  }
  return kMostContactsPerPair;
}

void set_mass(dxBody* body, const RigidMass& rigid) {
  const Matrix3& i = rigid.inertia_kg_m2;
  dMass mass;
  dMassSetParameters(&mass, rigid.mass_kg, 0, 0, 0, i[0][0], i[1][1], i[2][2], i[0][1], i[0][2], i[1][2]);
  dBodySetMass(body, &mass);
}

void move(dxBody* body, const Motion& motion) {
  const Rotation r = normalized(motion.rotation);
  const dQuaternion q = {r.w, r.x, r.y, r.z};
  dBodySetPosition(body, motion.position_m.x, motion.position_m.y, motion.position_m.z);
  dBodySetQuaternion(body, q);
  if (dBodyIsKinematic(body)) return;
  dBodySetLinearVel(body, motion.velocity_m_s.x, motion.velocity_m_s.y, motion.velocity_m_s.z);
  dBodySetAngularVel(body, motion.spin_rad_s.x, motion.spin_rad_s.y, motion.spin_rad_s.z);
  dBodyEnable(body);
}

}  // namespace

struct Simulation::Ode {
  explicit Ode(const SceneDescription& scene);
  void collide(dxGeom* first, dxGeom* second);
  void add_contact(const Item& body, const Item& other, dContactGeom geom);
  void wake_all();

  double step_s, bounce_threshold_m_s;
  unsigned long seed, steps = 0;
  std::unique_ptr<dxWorld, WorldDeleter> world{dWorldCreate()};
  std::unique_ptr<dxSpace, SpaceDeleter> space{dHashSpaceCreate(nullptr)};
  std::unique_ptr<dxJointGroup, JointsDeleter> joints{dJointGroupCreate(0)};
  std::map<BodyId, Item> items;  // ordered, so that the same scene is solved in the same order
  std::array<dContactGeom, kMostContactsFound> found{};
  std::vector<Touch> touches;
  std::array<dJointFeedback, kMostContactsPerStep> feedback{};  // of the touch of the same number
  std::size_t dropped = 0;
};

Simulation::Ode::Ode(const SceneDescription& scene)
    : step_s(scene.step_s),
      bounce_threshold_m_s(scene.contact.bounce_threshold_m_s),
      seed(static_cast<unsigned long>(scene.seed)) {
  const SoftConstraint soft = soft_constraint(scene.contact.spring_n_m, scene.contact.damper_ns_m, step_s);
  dWorldSetGravity(world.get(), scene.gravity_m_s2.x, scene.gravity_m_s2.y, scene.gravity_m_s2.z);
  dWorldSetERP(world.get(), soft.erp);
  dWorldSetCFM(world.get(), soft.cfm);
  dWorldSetContactMaxCorrectingVel(world.get(), kFastestCorrection_m_s);
  dWorldSetMaxAngularSpeed(world.get(), 2 * range::kSpin_rad_s.high);
  dWorldSetAutoDisableFlag(world.get(), 1);
  dWorldSetAutoDisableTime(world.get(), kSleepAfter_s);
  dWorldSetAutoDisableSteps(world.get(), 0);
  dWorldSetAutoDisableLinearThreshold(world.get(), kSleepSpeed_m_s);
  dWorldSetAutoDisableAngularThreshold(world.get(), kSleepSpin_rad_s);
  dSpaceSetCleanup(space.get(), 0);
  touches.reserve(kMostContactsPerStep);
}

void Simulation::Ode::collide(dxGeom* first, dxGeom* second) {
  const Item* a = static_cast<const Item*>(dGeomGetData(first));
  const Item* b = static_cast<const Item*>(dGeomGetData(second));
  if (!a->awake() && !b->awake()) return;
  const int count = dCollide(first, second, kMostContactsFound, found.data(), sizeof(dContactGeom));
  const std::span points(found.data(), static_cast<std::size_t>(count));
  const std::size_t kept = choose_contacts(points);
  const bool swap = !a->movable();  // a joint's first body must be one that moves
  for (dContactGeom geom : points.first(kept)) {
    if (swap) {
      for (int k = 0; k < 3; ++k) geom.normal[k] = -geom.normal[k];
      std::swap(geom.g1, geom.g2);
    }
    add_contact(swap ? *b : *a, swap ? *a : *b, geom);
  }
}

// The normal points into `body`.
void Simulation::Ode::add_contact(const Item& body, const Item& other, dContactGeom geom) {
  if (touches.size() == kMostContactsPerStep) {
    ++dropped;
    return;
  }
  const Vec3 approach = other.velocity_at(geom.pos) - body.velocity_at(geom.pos);
  const Surface surface = combine(body.surface, other.surface);
  dContact contact{};
  contact.geom = geom;
  contact.surface.mode = dContactBounce | dContactApprox1;
  contact.surface.mu = surface.friction;
  contact.surface.bounce = surface.restitution;
  contact.surface.bounce_vel = bounce_threshold_m_s;
  dxJoint* joint = dJointCreateContact(world.get(), joints.get(), &contact);
  dJointAttach(joint, body.body.get(), other.body.get());
  dJointSetFeedback(joint, &feedback[touches.size()]);
  touches.push_back(
      {body.id, other.id, to_vec3(geom.pos), {}, dot(approach, to_vec3(geom.normal)), surface.contact_time_s});
}

// What slept on a body that has gone must fall.
void Simulation::Ode::wake_all() {
  for (auto& [id, item] : items) {
    if (item.movable()) dBodyEnable(item.body.get());
  }
}

Simulation::Simulation(const SceneDescription& scene) {
  const OdeLock lock;
  ode_ = std::make_unique<Ode>(scene);
}

Simulation::~Simulation() {
  const OdeLock lock;
  ode_.reset();
}

void Simulation::add_static(BodyId id, const StaticDescription& description) {
  const OdeLock lock;
  Item& item = ode_->items[id];
  item.id = id;
  item.surface = description.surface;
  item.shape = make_static(ode_->space.get(), description);
  dGeomSetData(item.shape.geom.get(), &item);
}

void Simulation::put_body(BodyId id, const Solid& solid, const Motion& motion, const Surface& surface, bool fixed) {
  remove_body(id);
  const OdeLock lock;
  Item& item = ode_->items[id];
  item.id = id;
  item.surface = surface;
  item.body.reset(dBodyCreate(ode_->world.get()));
  item.shape = make_shape(ode_->space.get(), solid.shape);
  set_mass(item.body.get(), solid.mass);
  if (fixed) dBodySetKinematic(item.body.get());
  dGeomSetData(item.shape.geom.get(), &item);
  dGeomSetBody(item.shape.geom.get(), item.body.get());
  const Vec3 center = solid.shape.center_m;
  dGeomSetOffsetPosition(item.shape.geom.get(), center.x, center.y, center.z);
  dBodySetFiniteRotationMode(item.body.get(), 1);  // exact for a constant spin, however fast
  move(item.body.get(), motion);
}

void Simulation::remove_body(BodyId id) {
  const OdeLock lock;
  ode_->items.erase(id);
  ode_->wake_all();
}

Motion Simulation::motion(BodyId id) const {
  const OdeLock lock;
  dxBody* body = ode_->items.at(id).body.get();
  const dReal* q = dBodyGetQuaternion(body);
  return {to_vec3(dBodyGetPosition(body)),
          {q[1], q[2], q[3], q[0]},
          to_vec3(dBodyGetLinearVel(body)),
          to_vec3(dBodyGetAngularVel(body))};
}

void Simulation::set_motion(BodyId id, const Motion& motion) {
  const OdeLock lock;
  move(ode_->items.at(id).body.get(), motion);
}

std::span<const Touch> Simulation::step() {
  const OdeLock lock;
  Ode& ode = *ode_;
  ode.touches.clear();
  ode.dropped = 0;
  dSpaceCollide(ode.space.get(), &ode,
                [](void* data, dxGeom* first, dxGeom* second) { static_cast<Ode*>(data)->collide(first, second); });
  if (ode.touches.size() <= kMostExactContacts) {
    dWorldStep(ode.world.get(), ode.step_s);
  } else {
    dRandSetSeed(ode.seed + ode.steps);  // it visits contacts in random order, from one generator for the process
    dWorldQuickStep(ode.world.get(), ode.step_s);
  }
  ++ode.steps;
  for (std::size_t k = 0; k < ode.touches.size(); ++k) {
    ode.touches[k].impulse_ns = ode.step_s * to_vec3(ode.feedback[k].f1);
  }
  dJointGroupEmpty(ode.joints.get());
  return ode.touches;
}

std::size_t Simulation::dropped_contacts() const { return ode_->dropped; }

}  // namespace ringdown::scene
