#include "engine/scene/ode/simulation.h"

#include "engine/scene/fixed_contacts.h"
#include "engine/scene/fresh_pairs.h"
#include "engine/scene/ode/contact_joints.h"
#include "engine/scene/ode/flight_probe.h"
#include "engine/scene/ode/islands.h"
#include "engine/scene/ode/joint.h"
#include "engine/scene/ode/lock.h"
#include "engine/scene/ode/near_pairs.h"
#include "engine/scene/pair_filter.h"
#include "engine/scene/rotation.h"

#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

// One step of the simulation, downward:
//
// 1. A step is done in parts. Each part is as long as the fastest body may fly and turn without passing through an
//    obstacle (ode/flight_probe.h), and at most the rest of the step (Simulation::step). Mostly a step has one part.
// 2. In a part, contacts are found and become contact joints with friction and restitution (ode/contact_joints.h).
//    Bodies that touch or are joined form islands (islands.h).
// 3. ODE's exact solver finds the impulses if no island has more contact points than it can solve in time, and ODE's
//    iterative solver otherwise. Before the exact solver runs, bodies that touch only what cannot move are solved
//    without it (fixed_contacts.h). If the exact solver warns that it failed, the bodies are restored and the iterative
//    one is used (State::solve).
// 4. If an island has gained energy in the part, its bodies are restored and it is solved again, with the same contacts
//    and less restitution (State::do_part). Any further gain is removed from the island's velocities.
//
// Solving an island again changes nothing in others: these are settled (islands.h), and their bodies pause.
namespace ringdown::scene {
namespace {

// If fewer than one body in this many is awake, each awake body searches for its contacts by itself.
constexpr std::size_t kFewAwake = 16;

// A body that has moved more slowly than this for kSleepAfter_s sleeps until something touches it. Speeds are averaged
// over kSleepSamples steps, because the iterative solver leaves resting bodies trembling.
constexpr double kSleepAfter_s = 0.5, kSleepSpeed_m_s = 0.01, kSleepSpin_rad_s = 0.1;
constexpr int kSleepSamples = 10;

// Bodies that have stayed in place for this long sleep, even if they tremble. Of 600 starts of crossed knives 0.5 s
// left nine trembling for more than a second; 0.3 s leaves two to four.
constexpr double kSleepWhenStill_s = 0.3;

// Maximum number of times that a part is solved again with less restitution, the last time with none, until it gains no
// energy.
constexpr int kMaxRounds = 6;

// The exact solver's time grows with the cube of an island's contact points, and a long step leaves more time.
std::size_t max_exact_contacts(double step_s) {
  return static_cast<std::size_t>(kMaxExactContacts * std::cbrt(step_s / 0.002));
}

// The iterative solver's time grows with contacts times iterations. A tower needs many iterations; a heap, which has
// more contacts, needs fewer.
int iterations(std::size_t contacts) {
  return std::clamp(static_cast<int>(6000 / std::max<std::size_t>(contacts, 1)), 20, 60);
}

struct BodyJoint {
  BodyId body = 0;
  std::optional<BodyId> other;
  JointDescription description;
};

struct Joint {
  BodyJoint between;
  OdeJoint joint;
};

// A part of a step.
struct Part {
  double begin_s, length_s;                                        // in the step
  const std::atomic<int>* given_up;                                // see Simulation::step()
  std::vector<std::pair<Collider*, Collider::State>> before = {};  // its bodies' state at its beginning
};

}  // namespace

struct SimulationMemory {
  ContactJoints::Memory contacts;
  struct Body {  // ODE's own clock of a body's rest starts again
    BodyId id = 0;
    Motion motion;
    double owed_j = 0;
    Stillness stillness;
    bool awake = false;
  };
  std::vector<Body> bodies;  // that can move
};

struct Simulation::State {
  explicit State(const SceneDescription& scene);

  void do_part(Part part);
  void find_islands(Part& part);
  void find_contacts(const Part& part);
  // move() and solve() return true if the part was solved exactly.
  bool move(const Part& part);
  bool solve(const Part& part);
  void correct_friction(const Part& part);
  void run(int (*solver)(dxWorld*, double), const Part& part);
  void restore(const Part& part);
  void move_driven(double done_s);

  template <class... Of>
  Collider& add(BodyId id, const Of&... of);
  void remove(BodyId gone);
  void wake_all();
  void let_still_bodies_sleep();
  void release_parted();
  void join(const BodyJoint& joint);
  [[nodiscard]] std::vector<BodyJoint> joints_of(BodyId id) const;

  const double step_s, spring_n_m, damper_ns_m;
  const Vec3 gravity_m_s2;
  const std::size_t max_exact;
  const std::unique_ptr<dxWorld, WorldDeleter> world{dWorldCreate()};
  const std::unique_ptr<dxSpace, SpaceDeleter> space{dSimpleSpaceCreate(nullptr)};
  const FlightProbe probe;
  // Bodies and joints, which add(), join() and remove() change:
  std::map<BodyId, Collider> colliders;
  std::vector<Collider*> in_order;  // of their numbers, so that the same scene is solved in the same order
  std::vector<Joint> joints;        // declared after the bodies, which must be destroyed last
  PairFilter filter;
  FreshPairs fresh;
  // Used in a step:
  ContactJoints contacts;
  NearPairs near;
  Islands islands;
  unsigned long seed;  // of the part
  std::vector<MovedBody> moved;
  bool asleep = false;
};

Simulation::State::State(const SceneDescription& scene)
    : step_s(scene.step_s),
      spring_n_m(scene.contact.spring_n_m),
      damper_ns_m(scene.contact.damper_ns_m),
      gravity_m_s2(scene.gravity_m_s2),
      max_exact(max_exact_contacts(scene.step_s)),
      contacts(world.get(), scene),
      seed(static_cast<unsigned long>(scene.seed)) {
  dWorldSetGravity(world.get(), scene.gravity_m_s2.x, scene.gravity_m_s2.y, scene.gravity_m_s2.z);
  dWorldSetContactMaxCorrectingVel(world.get(), kMaxCorrection_m_s);
  dWorldSetContactSurfaceLayer(world.get(), kContactLayer_m);
  dWorldSetMaxAngularSpeed(world.get(), 2 * range::kSpin_rad_s.high);
  dWorldSetAutoDisableFlag(world.get(), 1);
  dWorldSetAutoDisableTime(world.get(), kSleepAfter_s);
  dWorldSetAutoDisableSteps(world.get(), 0);
  dWorldSetAutoDisableAverageSamplesCount(world.get(), kSleepSamples);
  dWorldSetAutoDisableLinearThreshold(world.get(), kSleepSpeed_m_s);
  dWorldSetAutoDisableAngularThreshold(world.get(), kSleepSpin_rad_s);
  dSpaceSetCleanup(space.get(), 0);
}

void Simulation::State::do_part(Part part) {
  const double part_s = part.length_s;
  const SoftConstraint soft = soft_constraint(spring_n_m, damper_ns_m, part_s);
  dWorldSetERP(world.get(), soft.erp);
  dWorldSetCFM(world.get(), soft.cfm);
  contacts.begin_part(part.begin_s, part_s);
  for (Collider* collider : in_order) {  // ODE does not know of gravity factors
    if (collider->gravity_factor == 1 || !collider->awake()) continue;
    collider->add_force((collider->gravity_factor - 1) * collider->mass_kg * gravity_m_s2, {});
  }
  for (Joint& joint : joints) joint.joint.drive(part_s);
  find_islands(part);
  bool exact = move(part);
  for (int round = 1; round <= kMaxRounds && !contacts.part_points().empty(); ++round) {
    if (!islands.gained_energy(contacts.part_points(), part_s, gravity_m_s2, exact, round == kMaxRounds)) break;
    if (!exact) islands.unsettle_all();
    restore(part);
    exact = move(part);
  }
  islands.end_part(contacts.part_points(), part_s, gravity_m_s2);
  contacts.move_bodies_apart(islands);
  for (Collider* member : islands.members()) member->pay_for_lifts(islands.contacts_of(*member) > 0);
  ++seed;
  contacts.end_part();
}

void Simulation::State::find_islands(Part& part) {
  islands.open(in_order);
  find_contacts(part);
  for (const auto& [between, joint] : joints) {
    islands.join(colliders.at(between.body), between.other ? &colliders.at(*between.other) : nullptr);
  }
  for (Collider* member : islands.members()) part.before.emplace_back(member, member->state());
}

bool Simulation::State::move(const Part& part) {
  contacts.bounce(islands);
  const bool exact = solve(part);
  islands.settle_all();
  return exact;
}

// If few bodies are awake, each of them searches for its contacts by itself: that is cheaper than sorting all bodies.
void Simulation::State::find_contacts(const Part& part) {
  const auto collide = [&](Collider& one, Collider& two) {
    const bool given_up = part.given_up && *part.given_up > 0;
    if (given_up || fresh.contains(one.id, two.id)) return;
    if (filter.may_touch(one.id, two.id)) contacts.collide(one, two, islands);
  };
  const auto awake = std::ranges::count_if(in_order, &Collider::awake);
  if (static_cast<std::size_t>(awake) * kFewAwake >= in_order.size()) {
    for (const auto& [one, two] : near.find(in_order)) collide(*one, *two);
    return;
  }
  for (const Collider* from : in_order) {
    if (!from->awake()) continue;
    auto meet = [&](Collider& one, Collider& two) {
      const Collider& met = &one == from ? two : one;
      const bool done = met.awake() && met.id < from->id;  // `met` found this pair already
      if (!done) collide(one, two);
    };
    dSpaceCollide2(from->shape.geom.get(), reinterpret_cast<dxGeom*>(space.get()), &meet,
                   [](void* data, dxGeom* one, dxGeom* two) {
                     (*static_cast<decltype(meet)*>(data))(collider_of(one), collider_of(two));
                   });
  }
}

bool Simulation::State::solve(const Part& part) {
  if (islands.max_contacts() <= max_exact) {
    contacts.hand_over(true, islands);
    contacts.push_lone_bodies();
    OdeLock::warnings() = 0;
    run(dWorldStep, part);
    if (OdeLock::warnings() == 0) correct_friction(part);
    if (OdeLock::warnings() == 0) return true;
    islands.unsettle_all();
    restore(part);
  }
  contacts.hand_over(false, islands);
  // The iterative solver visits contacts in random order, drawn from one generator for the whole process.
  dRandSetSeed(seed);
  dWorldSetQuickStepNumIterations(world.get(), iterations(contacts.part_points().size()));
  run(dWorldQuickStep, part);
  return false;
}

// Lets one of ODE's solvers move the islands that are not settled.
void Simulation::State::run(int (*solver)(dxWorld*, double), const Part& part) {
  std::vector<Collider*> pausing;
  for (Collider* member : islands.members()) {
    if (islands.is_settled(*member) && member->awake()) pausing.push_back(member);
  }
  for (const Collider* member : pausing) dBodyDisable(member->body.get());
  solver(world.get(), part.length_s);
  for (const auto& [collider, state] : part.before) {
    if (collider->awake() && !collider->round) collider->turn(state.motion.rotation, part.length_s);
  }
  for (const Collider* member : pausing) dBodyEnable(member->body.get());
  contacts.read_impulses(islands);
}

// ODE bounds friction by the normal impulse that would occur without friction. If a body lands on an edge, friction
// turns the body and so changes that impulse: by 18 % in the worst case seen. The islands in which a body lands are
// solved again with bounds from the last solution, until these agree with the solution's own impulses. If they do not
// converge, at a very high friction or in a heap, ODE's first solution is used.
void Simulation::State::correct_friction(const Part& part) {
  contacts.settle_all_but_landing(islands);
  FrictionRounds rounds(contacts.part_points().size(), islands.members().size());
  while (contacts.bound_friction(rounds, islands)) {
    restore(part);
    run(dWorldStep, part);
    if (OdeLock::warnings() == 0) continue;
    if (!rounds.give_up()) return;
    OdeLock::warnings() = 0;
  }
}

// Restores the bodies of islands that are not settled.
void Simulation::State::restore(const Part& part) {
  for (const auto& [collider, state] : part.before) {
    if (!islands.is_settled(*collider)) collider->restore(state);
  }
  move_driven(part.begin_s);
}

// Places driven bodies at their poses after `done_s` of the step. This is needed because each of ODE's solutions, of
// which there may be several, moves them too.
void Simulation::State::move_driven(double done_s) {
  for (Collider* collider : in_order) collider->follow(done_s);
}

void Simulation::State::join(const BodyJoint& joint) {
  Collider* const joined[] = {&colliders.at(joint.body), joint.other ? &colliders.at(*joint.other) : nullptr};
  dxBody* const other = joined[1] ? joined[1]->body.get() : nullptr;
  if (other && !joint.description.collides) filter.part(joint.body, *joint.other);
  joints.push_back({joint, OdeJoint(world.get(), joined[0]->body.get(), other, joint.description)});
  for (Collider* collider : std::span(joined, other ? 2 : 1)) collider->sleep.join(joints.back().joint.keeps_moving());
}

// The joints of a body, described as they are now, so that they can be made again.
std::vector<BodyJoint> Simulation::State::joints_of(BodyId id) const {
  std::vector<BodyJoint> found;
  for (const auto& [between, joint] : joints) {
    if (between.body == id || between.other == id) found.push_back({between.body, between.other, joint.now()});
  }
  return found;
}

// Lets bodies sleep that lie on others and have all stayed in place for kSleepWhenStill_s. The bodies of an island
// sleep together, because a moving one would wake the others. None sleeps while a driven body moves, which may shake
// them.
void Simulation::State::let_still_bodies_sleep() {
  const bool shaken = std::ranges::any_of(in_order, &Collider::driven_about);
  for (Collider* collider : in_order) {
    if (shaken || !collider->sleep.was_awake() || !collider->awake()) collider->sleep.stir();
  }
  if (shaken) return;
  const auto for_each_awake = [this](const auto& call) {
    for (Collider* collider : in_order) {
      if (collider->sleep.was_awake() && collider->awake()) call(*collider, islands.island_of(*collider));
    }
  };
  std::vector<const Collider*> moving;  // islands, in order
  for_each_awake([&](Collider& collider, const Collider* island) {
    if (collider.sleep.stays_for(collider.motion(), collider.outer_radius_m, step_s) < kSleepWhenStill_s)
      moving.push_back(island);
  });
  std::ranges::sort(moving);
  for_each_awake([&](Collider& collider, const Collider* island) {
    if (!std::ranges::binary_search(moving, island) && islands.contacts_of(collider) > 0) collider.sleep.fall();
  });
}

template <class... Of>
Collider& Simulation::State::add(BodyId id, const Of&... of) {
  Collider& collider = colliders.try_emplace(id, id, of...).first->second;
  in_order.insert(std::ranges::lower_bound(in_order, id, {}, &Collider::id), &collider);
  return collider;
}

// Removes a body with its joints, and wakes all others: what rested on it must fall.
void Simulation::State::remove(BodyId gone) {
  if (!colliders.contains(gone)) return;
  std::erase_if(joints, [&](const Joint& joint) {
    const auto& [body, other, description] = joint.between;
    if (body != gone && other != gone) return false;
    if (other) filter.unpart(body, *other);
    return true;
  });
  filter.forget(gone);
  fresh.forget(gone);
  std::erase(in_order, &colliders.at(gone));
  colliders.erase(gone);
  contacts.forget(gone);
  wake_all();
}

// Lets pieces of a broken body touch that have come apart. The test costs a projection of both hulls, and only for
// pairs whose boxes overlap and that move.
void Simulation::State::release_parted() {
  const auto hull_of = [](const Collider& collider) {
    const Motion motion = collider.motion();
    return PosedHull{collider.shape.points, to_matrix(motion.rotation), motion.position_m};
  };
  fresh.release([&](BodyId a, BodyId b, Vec3& direction) {
    const Collider &one = colliders.at(a), &two = colliders.at(b);
    if (!one.awake() && !two.awake()) return false;
    double first[6], second[6];
    dGeomGetAABB(one.shape.geom.get(), first);
    dGeomGetAABB(two.shape.geom.get(), second);
    for (int k = 0; k < 6; k += 2) {
      if (first[k] > second[k + 1] + kFreshGap_m || second[k] > first[k + 1] + kFreshGap_m) return true;
    }
    const PosedHull of_one = hull_of(one), of_two = hull_of(two);
    if (direction == Vec3{}) {
      const Vec3 way = of_two.position_m - of_one.position_m;
      direction = length(way) > 0 ? (1 / length(way)) * way : Vec3{0, 0, 1};
    }
    return are_apart(of_one, of_two, kFreshGap_m, direction);
  });
}

void Simulation::State::wake_all() {
  asleep = false;
  for (Collider* collider : in_order) {
    if (collider->movable()) dBodyEnable(collider->body.get());
  }
}

Simulation::Simulation(const SceneDescription& scene) {
  const OdeLock lock;
  state_ = std::make_unique<State>(scene);
}

Simulation::~Simulation() {
  const OdeLock lock;
  state_.reset();
}

void Simulation::add_static(BodyId id, const StaticDescription& description) {
  const OdeLock lock;
  state_->add(id, description, state_->space.get());
}

void Simulation::put_body(BodyId id, const Solid& solid, const Motion& motion, const FrictionSurface& surface,
                          bool fixed, double gravity_factor) {
  const OdeLock lock;
  const std::vector<BodyJoint> kept = state_->joints_of(id);
  state_->remove(id);
  const State& state = *state_;
  state_->add(id, solid, surface, fixed, gravity_factor, state.world.get(), state.space.get()).move(motion);
  for (const BodyJoint& joint : kept) state_->join(joint);
  state_->asleep = false;
}

void Simulation::set_filter(BodyId id, const CollisionFilter& filter) { state_->filter.set(id, filter); }

void Simulation::keep_from_touching(std::span<const BodyId> pieces, std::optional<BodyId> whole) {
  state_->fresh.add(pieces, whole);
}

void Simulation::remove_body(BodyId id) {
  const OdeLock lock;
  state_->remove(id);
}

void Simulation::add_joint(BodyId body, std::optional<BodyId> other, const JointDescription& description) {
  const OdeLock lock;
  state_->join({body, other, description});
}

void Simulation::set_motion(BodyId id, const Motion& motion) {
  const OdeLock lock;
  state_->colliders.at(id).move(motion);
  state_->asleep = false;
}

void Simulation::place(BodyId id, const Motion& motion) {
  const OdeLock lock;
  state_->colliders.at(id).move(motion);
  state_->contacts.forget(id);
  state_->wake_all();
}

void Simulation::rest(BodyId id, const Motion& motion) {
  const OdeLock lock;
  Collider& collider = state_->colliders.at(id);
  collider.move({motion.position_m, motion.rotation, {}, {}});
  collider.sleep.fall();
}

std::shared_ptr<const SimulationMemory> Simulation::memory() const {
  const OdeLock lock;
  SimulationMemory memory{.contacts = state_->contacts.memory(), .bodies = {}};
  for (const Collider* collider : state_->in_order) {
    if (collider->movable())
      memory.bodies.push_back(
          {collider->id, collider->motion(), collider->owed_j, collider->sleep.stillness(), collider->awake()});
  }
  return std::make_shared<const SimulationMemory>(std::move(memory));
}

void Simulation::recall(const SimulationMemory& memory) {
  const OdeLock lock;
  state_->contacts.recall(memory.contacts);
  for (const SimulationMemory::Body& body : memory.bodies) {
    Collider& collider = state_->colliders.at(body.id);
    collider.move(body.motion);
    collider.owed_j = body.owed_j;
    if (!body.awake) collider.sleep.fall();
    collider.sleep.recall(body.stillness);
  }
  state_->asleep = false;
}

void Simulation::correct(BodyId id, const Motion& motion) {
  const OdeLock lock;
  Collider& collider = state_->colliders.at(id);
  const double owed_j = collider.owed_j;
  const Stillness stillness = collider.sleep.stillness();
  collider.move(motion);
  collider.owed_j = owed_j;
  collider.sleep.recall(stillness);
  state_->asleep = false;
}

void Simulation::number_step(std::uint64_t number) { state_->seed = static_cast<unsigned long>(number); }

void Simulation::drive(BodyId id, const Motion& motion) {
  const OdeLock lock;
  Collider& collider = state_->colliders.at(id);
  collider.drive(motion);
  if (collider.driven_about()) state_->wake_all();
}

std::span<const ContactPoint> Simulation::step(const std::atomic<int>* given_up) {
  const OdeLock lock;
  State& state = *state_;
  state.contacts.begin_step();
  state.release_parted();
  for (Collider* collider : state.in_order) collider->sleep.begin_step();
  double done_s = 0;
  for (int k = 1; done_s < state.step_s; ++k) {
    const double rest_s = state.step_s - done_s;
    double part_s = rest_s;
    for (Collider* collider : state.in_order) {
      if (k < kMaxParts && collider->awake())
        part_s = std::min(part_s, state.probe.free_flight(*collider, rest_s, state.space.get(), state.fresh));
    }
    state.do_part({done_s, part_s, given_up});
    done_s = part_s == rest_s ? state.step_s : done_s + part_s;
    state.move_driven(done_s);
  }
  state.let_still_bodies_sleep();
  state.moved.clear();
  for (const Collider* collider : state.in_order) {
    if (collider->sleep.was_awake() || collider->driven()) state.moved.push_back({collider->id, collider->motion()});
  }
  state.asleep = std::ranges::none_of(state.in_order, &Collider::awake);
  return state.contacts.points();
}

std::span<const MovedBody> Simulation::moved() const { return state_->moved; }

bool Simulation::asleep() const { return state_->asleep; }

std::size_t Simulation::dropped_contacts() const { return state_->contacts.dropped(); }

}  // namespace ringdown::scene
