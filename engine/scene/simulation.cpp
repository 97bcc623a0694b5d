#include "engine/scene/simulation.h"

#include "engine/scene/ode_contacts.h"
#include "engine/scene/ode_groups.h"
#include "engine/scene/ode_item.h"
#include "engine/scene/ode_joint.h"
#include "engine/scene/ode_rolling.h"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdarg>
#include <map>
#include <mutex>
#include <vector>

namespace ringdown::scene {
namespace {

// What ODE would print: so far only that its exact solver has left some contacts without a force, as it may in scenes
// of great symmetry. Counted under the lock.
std::size_t complaints_of_ode = 0;
void count_complaint(int, const char*, va_list) { ++complaints_of_ode; }

// Held during every call into ODE. The first one on a thread gives ODE its data for that thread.
class OdeLock {
 public:
  OdeLock() : lock_(mutex()) {
    static const int ready = dInitODE2(0);
    dSetMessageHandler(count_complaint);
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
struct JointsDeleter {
  void operator()(dxJointGroup* joints) const { dJointGroupDestroy(joints); }
};

// Fewer than one body in so many: each looks for what it touches by itself.
constexpr std::size_t kFewAwake = 16;

// Below this the direction of sliding is noise.
constexpr double kMinSlip_m_s = 1e-6;

// A body that has hardly moved for this long sleeps until something touches it.
// Means of a few steps tell a body that rests from one that moves: the iterative solver leaves it trembling.
constexpr double kSleepAfter_s = 0.5, kSleepSpeed_m_s = 0.01, kSleepSpin_rad_s = 0.1;
constexpr int kSleepSamples = 10;

// The exact solver's time grows with the cube of the contacts of a group, and a long step leaves more of it. The
// iterative one's grows with their product with the iterations: many for a tower, which needs them, fewer for a heap.
std::size_t most_exact_contacts(double step_s) {
  return static_cast<std::size_t>(kMaxExactContacts * std::cbrt(step_s / 0.002));
}
int iterations(std::size_t contacts) {
  return std::clamp(static_cast<int>(6000 / std::max<std::size_t>(contacts, 1)), 20, 60);
}

// Pushing overlapping bodies apart faster than this would make a bounce, and energy, out of nothing.
constexpr double kMaxCorrection_m_s = 0.02;

// What contacts may make of energy in a step, as a share of what there is: rounding errors, and those of the solvers.
constexpr double kGain = 1e-3, kGainByIteration = 1e-2;

// What lies on something stays this deep in it: parted by a rounding error it would fall, and come in again.
constexpr double kLayer_m = 2e-5;

Vec3 to_vec3(const dReal* v) { return {v[0], v[1], v[2]}; }

// What falls is stopped too deep by what it went on to fall after it had touched: faster than it touched, and with a
// way back up. At a step of 2 ms a rebound of 0.4 m/s would come out 7 % too slow.
struct Landing {
  double bounce = 0;        // of the speed it has now, to leave the surface with what it should of the touch's
  double approach_m_s = 0;  // at the touch
  double share = 1;         // of the impulse that stops it now: the touch's, without what gravity has given since
};

// `pushed_m_s` is how fast its depth alone would be mended.
Landing landing(double restitution, double approach_m_s, double fall_m_s2, double depth_m, double part_s,
                double threshold_m_s, double pushed_m_s) {
  const double half_m_s = 0.5 * fall_m_s2 * part_s;  // velocities are those of half a step before, or after
  const double now = approach_m_s + half_m_s, gained = 2 * fall_m_s2 * depth_m;
  const double touched = std::sqrt(std::max(now * now - gained, 0.0));
  const double leaves = restitution * touched;
  const double rises = std::sqrt(std::max(leaves * leaves + gained, 0.0)) - half_m_s;
  const double after = leaves >= threshold_m_s ? std::clamp(rises, 0.0, approach_m_s) : restitution * approach_m_s;
  return {after / approach_m_s, touched,
          (touched + leaves) / (approach_m_s + std::max(after, pushed_m_s) + 2 * half_m_s)};
}

struct KeptJoint {
  BodyId body = 0;
  std::optional<BodyId> other;
  JointDescription description;
};

struct Joint {
  KeptJoint kept;
  OdeJoint joint;
};

}  // namespace

struct Simulation::Ode {
  explicit Ode(const SceneDescription& scene);
  void collide(dxGeom* first, dxGeom* second);
  void add_contact(Item& body, Item& other, dContactGeom geom);
  [[nodiscard]] Landing land(const Item& other, double restitution, double approach_m_s,
                             const dContactGeom& geom) const;
  void find_touches();
  [[nodiscard]] double pushed(double depth_m) const;
  void do_part();
  void move_all(std::size_t first_touch);
  [[nodiscard]] bool solve_exactly();
  void solve_by_iteration(std::size_t contacts_now);
  [[nodiscard]] double next_part(double rest_s);
  void remove(BodyId gone);
  void note_moved();
  void join(const KeptJoint& joint);
  [[nodiscard]] std::vector<KeptJoint> joints_of(BodyId id) const;

  double step_s, spring_n_m, damper_ns_m, bounce_threshold_m_s;
  Vec3 gravity_m_s2;
  double part_s = 0, found_s = 0;  // the part that is being done: its length, and from the beginning of the step to it
  unsigned long seed, parts = 0;
  std::unique_ptr<dxWorld, WorldDeleter> world{dWorldCreate()};
  std::unique_ptr<dxSpace, SpaceDeleter> space{dHashSpaceCreate(nullptr)};
  std::unique_ptr<dxJointGroup, JointsDeleter> contacts{dJointGroupCreate(0)};
  std::map<BodyId, Item> items;  // ordered, so that the same scene is solved in the same order
  std::vector<Joint> joints;     // declared after the bodies, which must go last
  Feelers feelers;
  std::array<dContactGeom, kMaxContactsFound> found{};
  std::vector<Touch> touches;
  std::vector<dJointFeedback> feedback{kMaxContactsPerStep};              // of the touch of the same number, as are
  std::vector<double> shares = std::vector<double>(kMaxContactsPerStep);  // of their impulses
  Groups groups;
  Loads loads;  // of the part before
  std::vector<Moved> moved;
  std::size_t dropped = 0, most_exact;
  bool asleep = false, exact = false;
  std::vector<std::pair<Item*, Item::State>> before;  // the part's motion
};

Simulation::Ode::Ode(const SceneDescription& scene)
    : step_s(scene.step_s),
      spring_n_m(scene.contact.spring_n_m),
      damper_ns_m(scene.contact.damper_ns_m),
      bounce_threshold_m_s(bounce_threshold(scene)),
      gravity_m_s2(scene.gravity_m_s2),
      seed(static_cast<unsigned long>(scene.seed)),
      most_exact(most_exact_contacts(scene.step_s)) {
  dWorldSetGravity(world.get(), scene.gravity_m_s2.x, scene.gravity_m_s2.y, scene.gravity_m_s2.z);
  dWorldSetContactMaxCorrectingVel(world.get(), kMaxCorrection_m_s);
  dWorldSetContactSurfaceLayer(world.get(), kLayer_m);
  dWorldSetMaxAngularSpeed(world.get(), 2 * range::kSpin_rad_s.high);
  dWorldSetAutoDisableFlag(world.get(), 1);
  dWorldSetAutoDisableTime(world.get(), kSleepAfter_s);
  dWorldSetAutoDisableSteps(world.get(), 0);
  dWorldSetAutoDisableAverageSamplesCount(world.get(), kSleepSamples);
  dWorldSetAutoDisableLinearThreshold(world.get(), kSleepSpeed_m_s);
  dWorldSetAutoDisableAngularThreshold(world.get(), kSleepSpin_rad_s);
  dSpaceSetCleanup(space.get(), 0);
  touches.reserve(kMaxContactsPerStep);
}

void Simulation::Ode::collide(dxGeom* first, dxGeom* second) {
  Item* a = static_cast<Item*>(dGeomGetData(first));
  Item* b = static_cast<Item*>(dGeomGetData(second));
  if (!a->awake() && !b->awake()) return;
  const std::span<dContactGeom> points = find_contacts(first, second, found, part_s);
  const bool swap = !a->movable();  // a joint's first body must be one that moves
  for (dContactGeom geom : points) {
    if (swap) {
      for (int k = 0; k < 3; ++k) geom.normal[k] = -geom.normal[k];
      std::swap(geom.g1, geom.g2);
    }
    add_contact(swap ? *b : *a, swap ? *a : *b, geom);
  }
  if (points.empty() || (points.size() > 1 && !a->round && !b->round)) return;  // several points resist by themselves
  Item &body = swap ? *b : *a, &other = swap ? *a : *b;
  const double most_nm = combine(body.surface, other.surface).rolling_m * loads.of_n(body.id, other.id);
  if (most_nm == 0 || touches.empty()) return;
  const Touch& touch = touches.back();
  resist_rolling(body, other, touch.point_m, touch.normal, most_nm, gravity_m_s2, part_s);
}

// How fast what is so deep in another is to be moved out.
double Simulation::Ode::pushed(double depth_m) const {
  const double out_m_s = dWorldGetERP(world.get()) * std::max(depth_m - kLayer_m, 0.0) / part_s;
  return std::min(out_m_s, kMaxCorrection_m_s);
}

// Only what has come in within one part, against what does not fall along.
Landing Simulation::Ode::land(const Item& other, double restitution, double approach_m_s,
                              const dContactGeom& geom) const {
  const bool lands = approach_m_s > bounce_threshold_m_s && geom.depth <= approach_m_s * part_s;
  if (other.movable() || !lands) return {restitution, approach_m_s};
  const double fall_m_s2 = -dot(gravity_m_s2, to_vec3(geom.normal));
  return landing(restitution, approach_m_s, fall_m_s2, geom.depth, part_s, bounce_threshold_m_s, pushed(geom.depth));
}

// The normal points into `body`. Friction acts along two directions, each up to its limit: with the first along the
// sliding (or the rolling) they obey Coulomb's cone.
void Simulation::Ode::add_contact(Item& body, Item& other, dContactGeom geom) {
  if (touches.size() == kMaxContactsPerStep) {
    ++dropped;
    return;
  }
  const Motion of_body = body.motion(), of_other = other.motion();
  const Vec3 point = to_vec3(geom.pos), normal = to_vec3(geom.normal);
  const Vec3 approach = of_other.velocity_at(point) - of_body.velocity_at(point);
  SurfacePair surface = combine(body.surface, other.surface);
  if (!body.elastic || !other.elastic) surface.restitution = 0;
  dContact contact{};
  contact.geom = geom;
  contact.surface.mode = dContactBounce | dContactApprox1;
  contact.surface.mu = surface.friction;
  const Landing lands = land(other, surface.restitution, dot(approach, normal), geom);
  contact.surface.bounce = lands.bounce;
  contact.surface.bounce_vel = bounce_threshold_m_s;
  Vec3 along = approach - dot(approach, normal) * normal;
  if (length(along) < kMinSlip_m_s) along = cross(of_body.spin_rad_s - of_other.spin_rad_s, normal);
  if (const double speed = length(along); speed >= kMinSlip_m_s) {
    contact.surface.mode |= dContactFDir1;
    for (int k = 0; const double part : {along.x, along.y, along.z}) contact.fdir1[k++] = part / speed;
  }
  dxJoint* joint = dJointCreateContact(world.get(), contacts.get(), &contact);
  dJointAttach(joint, body.body.get(), other.body.get());
  dJointSetFeedback(joint, &feedback[touches.size()]);
  shares[touches.size()] = lands.share;
  const double approach_m_s = dot(approach, normal), pushed_m_s = pushed(geom.depth);
  const double leaves_m_s = approach_m_s > bounce_threshold_m_s ? lands.bounce * approach_m_s : 0;
  groups.unite(body, other, pushed_m_s > leaves_m_s ? pushed_m_s : 0);
  touches.push_back({body.id, other.id, point, normal, geom.depth, {}, lands.approach_m_s, found_s, of_body, of_other});
}

// The space looks at all its bodies; where few are awake, it is cheaper to look from each of those.
void Simulation::Ode::find_touches() {
  const auto awake = std::ranges::count_if(items, [](const auto& entry) { return entry.second.awake(); });
  if (static_cast<std::size_t>(awake) * kFewAwake >= items.size()) {
    return dSpaceCollide(space.get(), this,
                         [](void* data, dxGeom* one, dxGeom* two) { static_cast<Ode*>(data)->collide(one, two); });
  }
  struct Look {
    Ode* ode;
    Item* from;
  };
  for (auto& [id, item] : items) {
    if (!item.awake()) continue;
    Look look{this, &item};
    dSpaceCollide2(item.shape.geom.get(), reinterpret_cast<dxGeom*>(space.get()), &look,
                   [](void* data, dxGeom* one, dxGeom* two) {
                     const Look& l = *static_cast<Look*>(data);
                     const Item* a = static_cast<const Item*>(dGeomGetData(one));
                     const Item* met = a == l.from ? static_cast<const Item*>(dGeomGetData(two)) : a;
                     const bool twice = met->awake() && met->id < l.from->id;  // it has looked here already
                     if (!twice) l.ode->collide(one, two);
                   });
  }
}

// Or leaves everything as it was.
bool Simulation::Ode::solve_exactly() {
  complaints_of_ode = 0;
  dWorldStep(world.get(), part_s);
  if (complaints_of_ode == 0) return true;
  for (const auto& [item, state] : before) item->restore(state);
  return false;
}

// It visits contacts in random order, from one generator for the process.
void Simulation::Ode::solve_by_iteration(std::size_t contacts_now) {
  dRandSetSeed(seed + parts);
  dWorldSetQuickStepNumIterations(world.get(), iterations(contacts_now));
  dWorldQuickStep(world.get(), part_s);
}

// From contacts to motion.
void Simulation::Ode::move_all(std::size_t first_touch) {
  groups.open(items);
  find_touches();
  for (const Joint& joint : joints) {
    groups.join(items.at(joint.kept.body), joint.kept.other ? &items.at(*joint.kept.other) : nullptr);
  }
  before.clear();
  for (Item* item : groups.members()) before.emplace_back(item, item->state());
  exact = groups.most_contacts() <= most_exact && solve_exactly();
  if (!exact) solve_by_iteration(touches.size() - first_touch);
  for (std::size_t k = first_touch; k < touches.size(); ++k) touches[k].impulse_ns = part_s * to_vec3(feedback[k].f1);
}

// One part of a step. What gained energy is done again, without a bounce.
void Simulation::Ode::do_part() {
  const std::size_t first = touches.size(), dropped_before = dropped;
  const SoftConstraint soft = soft_constraint(spring_n_m, damper_ns_m, part_s);
  dWorldSetERP(world.get(), soft.erp);
  dWorldSetCFM(world.get(), soft.cfm);
  move_all(first);
  const auto now = [&] { return std::span<const Touch>(touches).subspan(first); };
  if (!now().empty() && groups.gain(now(), part_s, gravity_m_s2, exact ? kGain : kGainByIteration)) {
    for (const auto& [item, state] : before) {
      item->restore(state);
      dBodySetTorque(item->body.get(), 0, 0, 0);  // of rolling
    }
    dJointGroupEmpty(contacts.get());
    touches.resize(first);
    dropped = dropped_before;
    move_all(first);
    for (Item* item : groups.members()) item->elastic = true;
  }
  ++parts;
  for (std::size_t k = first; k < touches.size(); ++k) touches[k].impulse_ns = shares[k] * touches[k].impulse_ns;
  loads.note(now(), part_s);
  dJointGroupEmpty(contacts.get());
}

// How long until the first of the bodies must be looked at again.
double Simulation::Ode::next_part(double rest_s) {
  double free_s = rest_s;
  for (auto& [id, item] : items) {
    if (item.awake()) free_s = std::min(free_s, free_flight(item, rest_s, space.get(), feelers));
  }
  return free_s;
}

void Simulation::Ode::join(const KeptJoint& joint) {
  dxBody* other = joint.other ? items.at(*joint.other).body.get() : nullptr;
  joints.push_back({joint, OdeJoint(world.get(), items.at(joint.body).body.get(), other, joint.description)});
}

// As they are now, to be made again.
std::vector<KeptJoint> Simulation::Ode::joints_of(BodyId id) const {
  std::vector<KeptJoint> found_joints;
  for (const Joint& joint : joints) {
    if (joint.kept.body != id && joint.kept.other != id) continue;
    found_joints.push_back({joint.kept.body, joint.kept.other, joint.joint.now()});
  }
  return found_joints;
}

void Simulation::Ode::note_moved() {
  moved.clear();
  asleep = true;
  for (auto& [id, item] : items) {
    if (item.was_awake) moved.push_back({id, item.motion()});
    if (item.awake()) asleep = false;
  }
}

// What slept on it must fall.
void Simulation::Ode::remove(BodyId gone) {
  if (!items.contains(gone)) return;
  std::erase_if(joints, [gone](const Joint& joint) { return joint.kept.body == gone || joint.kept.other == gone; });
  items.erase(gone);
  asleep = false;
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
  item.inner_radius_m = inner_radius(description);
  item.shape = make_static(ode_->space.get(), description);
  dGeomSetData(item.shape.geom.get(), &item);
}

void Simulation::put_body(BodyId id, const Solid& solid, const Motion& motion, const Surface& surface, bool fixed) {
  const OdeLock lock;
  const std::vector<KeptJoint> kept = ode_->joints_of(id);
  ode_->remove(id);
  Item& item = ode_->items[id];
  item.id = id;
  item.surface = surface;
  item.inner_radius_m = inner_radius(solid.shape);
  item.round = solid.shape.type == ShapeType::sphere;
  item.body.reset(dBodyCreate(ode_->world.get()));
  item.shape = make_shape(ode_->space.get(), solid.shape);
  item.set_mass(solid.mass);
  if (fixed) dBodySetKinematic(item.body.get());
  dGeomSetData(item.shape.geom.get(), &item);
  dGeomSetBody(item.shape.geom.get(), item.body.get());
  const Vec3 center = solid.shape.center_m;
  dGeomSetOffsetPosition(item.shape.geom.get(), center.x, center.y, center.z);
  dBodySetFiniteRotationMode(item.body.get(), 1);  // exact for a constant spin, however fast
  item.move(motion);
  for (const KeptJoint& joint : kept) ode_->join(joint);
  ode_->asleep = false;
}

void Simulation::remove_body(BodyId id) {
  const OdeLock lock;
  ode_->remove(id);
}

void Simulation::add_joint(BodyId body, std::optional<BodyId> other, const JointDescription& description) {
  const OdeLock lock;
  ode_->join({body, other, description});
}

void Simulation::set_motion(BodyId id, const Motion& motion) {
  const OdeLock lock;
  ode_->items.at(id).move(motion);
  ode_->asleep = false;
}

std::span<const Touch> Simulation::step() {
  const OdeLock lock;
  Ode& ode = *ode_;
  ode.touches.clear();
  ode.dropped = 0;
  ode.found_s = 0;
  for (auto& [id, item] : ode.items) item.was_awake = item.awake();
  for (int k = 1; ode.found_s < ode.step_s; ++k) {
    const double rest_s = ode.step_s - ode.found_s;
    ode.part_s = k < kMaxParts ? ode.next_part(rest_s) : rest_s;
    ode.do_part();
    ode.found_s = ode.part_s == rest_s ? ode.step_s : ode.found_s + ode.part_s;
  }
  ode.note_moved();
  return ode.touches;
}

std::span<const Moved> Simulation::moved() const { return ode_->moved; }

bool Simulation::asleep() const { return ode_->asleep; }

std::size_t Simulation::dropped_contacts() const { return ode_->dropped; }

}  // namespace ringdown::scene
