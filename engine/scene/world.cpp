#include "engine/scene/world.h"

#include "engine/base/quote.h"
#include "engine/scene/body_store.h"
#include "engine/scene/check.h"
#include "engine/scene/contact/lasting_events.h"
#include "engine/scene/fracture/breaking_bodies.h"
#include "engine/scene/foley/playback.h"
#include "engine/scene/foley/scene_contacts.h"
#include "engine/scene/motion_path.h"
#include "engine/scene/rotation.h"
#include "engine/scene/scene_bodies.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <utility>

// A step of the world, downward: World::step does the step in equal parts of at most kMaxPart_s (State::do_part). A
// part lets waiting bodies in, moves bodies and finds their contact points (Simulation::step), turns these into events
// (ContactSounds::process), resets or removes bodies whose motion has become unreal (check_bodies), and replaces those
// that have broken by their pieces (BreakingBodies::replace_broken).
namespace ringdown::scene {
namespace {

bool within(Vec3 v, const Range& range) { return range.holds(v.x) && range.holds(v.y) && range.holds(v.z); }

bool is_real(const Motion& m) {
  const double turn = norm(m.rotation);
  return is_finite(m.position_m) && turn > 0.5 && turn < 2 && within(m.velocity_m_s, range::kVelocity_m_s) &&
         within(m.spin_rad_s, range::kSpin_rad_s);
}

// The number of equal parts of a step. A rounding error does not add another part.
int parts_of(double step_s) { return std::max(1, static_cast<int>(std::ceil(step_s / kMaxPart_s - 1e-9))); }

// A joint that is made when both of its bodies have entered the scene.
struct WaitingJoint {
  BodyId body = 0;
  std::optional<BodyId> other;
  JointDescription description;
  [[nodiscard]] bool joins(BodyId id) const { return body == id || other == id; }
};

// A body that World::remove() has taken out.
struct RemovedBody {
  BodyDescription description;  // as it enters the scene again
  bool spawned;
  std::vector<WaitingJoint> joints;
};

// The joints of a scene. Its bodies are numbered in the order of their descriptions.
std::vector<WaitingJoint> joints_of(const SceneDescription& scene) {
  const auto number = [&](const std::string& name) {
    return static_cast<BodyId>(std::ranges::find(scene.bodies, name, &BodyDescription::name) - scene.bodies.begin());
  };
  std::vector<WaitingJoint> joints;
  for (const JointDescription& joint : scene.joints) {
    joints.push_back({number(joint.body), {}, joint});
    if (!joint.other.empty()) joints.back().other = number(joint.other);
  }
  return joints;
}

}  // namespace

struct World::State {
  State(const SceneDescription& scene, double sample_rate_hz);

  Result<BodyId> add(BodyDescription description, bool spawned, std::optional<BodyId> id = {});
  Result<void> add_all(const EmitterDescription& emitter);
  void add_statics(const SceneDescription& scene);
  void let_in();
  void make_joints();
  void remove(BodyId id);
  void do_part();
  void check_bodies();
  void drive();
  [[nodiscard]] double time_s() const { return static_cast<double>(steps) * step_s + part * part_s; }

  double step_s;
  int parts;  // of each step
  double part_s;
  Vec3 gravity_m_s2;
  SceneBodies scene_bodies;
  BodyStore& store = scene_bodies.store;
  Simulation& simulation = scene_bodies.simulation;
  ContactSounds& sounds = scene_bodies.sounds;
  BreakingBodies breaking;
  const std::atomic<int>* given_up = nullptr;  // World::step()
  FrameClock timeline;
  std::vector<WaitingJoint> joints, made_joints;
  std::map<BodyId, RemovedBody> removed;
  std::vector<BodyId> driven;  // bodies that follow a path
  std::optional<FoleyPlayback> recovered;
  std::vector<ContactPoint> points;  // of a part: recovered and simulated ones
  std::int64_t steps = 0;
  bool numbered = false;    // by number_steps()
  int part = 0;             // of the step being done
  double next_start_s = 0;  // no waiting body enters before this time
  // Results of the last step:
  std::vector<synth::Event> events;
  std::vector<HeardContact> contacts;
  std::vector<RestDamping> rest_dampings;
  std::vector<std::string> notices;
  std::vector<synth::ObjectNumber> broken;
  std::vector<std::string> first_notices;  // for the report of the first step
  std::size_t dropped_events = 0, dropped_contacts = 0;
};

World::State::State(const SceneDescription& scene, double sample_rate_hz)
    : step_s(scene.step_s),
      parts(parts_of(scene.step_s)),
      part_s(scene.step_s / parts),
      gravity_m_s2(scene.gravity_m_s2),
      scene_bodies(scene, part_s),
      breaking(scene_bodies, scene.seed, sample_rate_hz),
      timeline{.sample_rate_hz = sample_rate_hz},
      joints(joints_of(scene)) {
  events.reserve(kMaxEventsPerStep);
}

Result<BodyId> World::State::add(BodyDescription description, bool spawned, std::optional<BodyId> id) {
  const bool has_path = description.path != nullptr;
  auto added = store.add(std::move(description), spawned, id);
  if (!added) return added;
  if (store.bodies().at(*added).description.breaks) {
    if (const auto ready = breaking.add(*added, store.bodies().at(*added)); !ready) {
      store.remove(*added);
      return fail(ready);
    }
  }
  if (has_path) driven.push_back(*added);
  next_start_s = 0;
  let_in();
  return added;
}

Result<void> World::State::add_all(const EmitterDescription& emitter) {
  BodyDescription body = emitter.body;
  for (std::uint64_t k = 1; k <= emitter.count; ++k) {
    body.name = formatted("{}-{}", emitter.name, k);
    if (const auto added = add(body, false); !added) return fail(added);
    body.start_s += emitter.every_s;
  }
  return {};
}

void World::State::add_statics(const SceneDescription& scene) {
  BodyId next = kFirstStatic;
  for (const StaticDescription& description : scene.statics) {
    simulation.add_static(next, description);
    simulation.set_filter(next, description.filter);
    sounds.set_side(next++, side_of(description));
  }
}

// Passes the bodies whose time has come to the simulation.
void World::State::let_in() {
  const double now_s = time_s();
  if (now_s < next_start_s) return;
  next_start_s = std::numeric_limits<double>::infinity();
  for (auto& [id, body] : store.bodies()) {
    if (!body.waiting) continue;
    if (body.description.start_s > now_s) {
      next_start_s = std::min(next_start_s, body.description.start_s);
      continue;
    }
    // A part moves a body by its velocity at the end of the part. Starting with the velocity of half a part earlier
    // makes a fall follow the true parabola.
    if (!body.description.fixed) {
      const Vec3 gravity = body.description.gravity_factor * gravity_m_s2;
      body.motion.velocity_m_s = body.motion.velocity_m_s - (0.5 * part_s) * gravity;
    }
    scene_bodies.put(id, body, *body.waiting);
    body.waiting.reset();
  }
  make_joints();
}

// Makes the joints whose bodies have all entered the scene.
void World::State::make_joints() {
  const auto is_in = [this](BodyId id) {
    const auto found = store.bodies().find(id);
    return found != store.bodies().end() && !found->second.waiting;
  };
  std::erase_if(joints, [&](const WaitingJoint& joint) {
    if (!is_in(joint.body) || (joint.other && !is_in(*joint.other))) return false;
    simulation.add_joint(joint.body, joint.other, joint.description);
    made_joints.push_back(joint);
    return true;
  });
}

void World::State::remove(BodyId id) {
  scene_bodies.remove(id);
  breaking.remove(id);
  for (auto* all : {&joints, &made_joints}) std::erase_if(*all, [id](const auto& joint) { return joint.joins(id); });
  std::erase(driven, id);
}

// Moves the bodies that follow paths.
void World::State::drive() {
  for (const BodyId id : driven) {
    const auto found = store.bodies().find(id);
    if (found == store.bodies().end() || found->second.waiting) continue;
    const Body& body = found->second;
    const BodyDescription& d = body.description;
    simulation.drive(id, motion_on(*d.path, {d.position_m, d.rotation}, body.mass.center_m, time_s(), part_s));
  }
}

void World::State::do_part() {
  let_in();
  drive();
  const bool asleep = simulation.asleep();
  if (asleep && sounds.quiet() && (!recovered || recovered->over(time_s()))) return;
  if (numbered) simulation.number_step(static_cast<std::uint64_t>(steps * parts + part));
  auto found = asleep ? std::span<const ContactPoint>() : simulation.step(given_up);
  if (recovered) {
    const auto played = recovered->step(time_s(), part_s);
    points.assign(found.begin(), found.end());
    points.insert(points.end(), played.begin(), played.end());
    found = points;
  }
  const auto moved = asleep ? std::span<const MovedBody>() : simulation.moved();
  const std::span<const synth::Event> part_events = sounds.process(found, moved, time_s(), timeline);
  events.insert(events.end(), part_events.begin(), part_events.end());
  contacts.insert(contacts.end(), sounds.heard().begin(), sounds.heard().end());
  rest_dampings.insert(rest_dampings.end(), sounds.rest_dampings().begin(), sounds.rest_dampings().end());
  dropped_events += sounds.dropped();
  if (asleep) return;
  dropped_contacts += simulation.dropped_contacts();
  check_bodies();
  const std::vector<synth::ObjectNumber> gone = breaking.replace_broken(found, events, notices);
  broken.insert(broken.end(), gone.begin(), gone.end());
}

// Stores the motion of bodies that moved. A body with an unreal motion goes back to its start, and is removed if that
// happens too often; a body that has left the scene is removed.
void World::State::check_bodies() {
  std::vector<BodyId> gone;
  auto entry = store.bodies().begin();
  for (const auto& [id, motion] : simulation.moved()) {  // in the order of the store
    while (entry->first < id) ++entry;
    Body& body = entry->second;
    body.motion = motion;
    if (is_real(body.motion) && within(body.motion.position_m, range::kPosition_m)) continue;
    const std::string who = "body " + quote(body.description.name);
    if (is_real(body.motion)) {
      notices.push_back(who + " left the scene and was removed");
      gone.push_back(id);
    } else if (body.resets++ < kMaxResets) {
      notices.push_back(who + " moved impossibly fast or far and was returned to its start, at rest");
      body.description.velocity_m_s = body.description.spin_rad_s = {};
      body.motion = body.start();
      simulation.set_motion(id, body.motion);
    } else {
      notices.push_back(who + " kept moving impossibly fast or far and was removed");
      gone.push_back(id);
    }
  }
  for (const BodyId id : gone) remove(id);
}

World::World(std::unique_ptr<State> state) : state_(std::move(state)) {}
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;
World::~World() = default;

Result<World> World::create(const SceneDescription& scene, std::span<const SoundingObject> objects,
                            double sample_rate_hz) {
  if (const auto ok = check(scene); !ok) return fail(ok);
  if (!(sample_rate_hz >= 1 && sample_rate_hz <= 1e7))
    return fail(ErrorKind::bad_input, "a scene needs a sample rate from 1 to 1e7 Hz");
  auto state = std::make_unique<State>(scene, sample_rate_hz);
  for (const SoundingObject& object : objects) {
    if (!object.bank) return fail(ErrorKind::bad_input, "object " + quote(object.name) + " has no bank");
    state->store.put_object(object);
  }
  state->add_statics(scene);
  for (const BodyDescription& body : scene.bodies) {
    if (const auto added = state->add(body, false); !added) return fail(added);
  }
  for (const EmitterDescription& emitter : scene.emitters) {
    if (const auto added = state->add_all(emitter); !added) return fail(added);
  }
  if (scene.foley) {
    auto recovered = recover_contacts(scene, state->store);
    if (!recovered) return fail(recovered);
    state->first_notices = recovered->notes;
    state->recovered.emplace(*std::move(recovered));
  }
  return World(std::move(state));
}

void World::set_start_frame(synth::Frame frame) { state_->timeline.start = frame; }

void World::number_steps() { state_->numbered = true; }

void World::set_sample_rate(double sample_rate_hz) {
  state_->timeline.sample_rate_hz = sample_rate_hz;
  state_->breaking.set_sample_rate(sample_rate_hz);
}

StepReport World::step(const std::atomic<int>* given_up) {
  State& state = *state_;
  state.given_up = given_up;
  state.events.clear();
  state.notices = std::exchange(state.first_notices, {});
  state.contacts.clear();
  state.rest_dampings.clear();
  state.broken.clear();
  state.dropped_events = state.dropped_contacts = 0;
  for (state.part = 0; state.part < state.parts; ++state.part) state.do_part();
  state.part = 0;
  ++state.steps;
  if (!std::ranges::is_sorted(state.events, {}, &synth::Event::frame))
    std::ranges::stable_sort(state.events, {}, &synth::Event::frame);
  return {state.events, state.rest_dampings,  state.contacts,        state.notices,
          state.broken, state.dropped_events, state.dropped_contacts};
}

bool World::sounds() const {
  return std::ranges::any_of(state_->store.bodies(), [](const auto& entry) { return entry.second.object.has_value(); });
}

bool World::has_lasting_contacts() const { return state_->sounds.has_lasting(); }

double World::time_s() const { return state_->time_s(); }
double World::step_s() const { return state_->step_s; }

Result<BodyId> World::spawn(BodyDescription body) {
  if (!body.object.empty() && !state_->store.find_object(body.object)) {
    return fail(ErrorKind::bad_input, "cannot spawn: no object " + quote(body.object) + " is loaded");
  }
  body.name += formatted("-{}", state_->store.next_id());
  return state_->add(std::move(body), true);
}

Result<void> World::remove(BodyId id) {
  const auto found = state_->store.bodies().find(id);
  if (found == state_->store.bodies().end())
    return fail(ErrorKind::bad_input, "cannot remove: the scene has no body {}", id);
  const Body& body = found->second;
  RemovedBody removed{body.description, body.spawned, {}};
  BodyDescription& again = removed.description;
  if (!body.waiting && !again.path) {
    put_at_rest(again,
                {body.motion.position_m - to_matrix(body.motion.rotation) * body.mass.center_m, body.motion.rotation});
  }
  again.scatter_m = 0;  // the position of a body that waits includes its scatter
  for (const auto* joints : {&state_->joints, &state_->made_joints}) {
    std::ranges::copy_if(*joints, std::back_inserter(removed.joints),
                         [id](const auto& joint) { return joint.joins(id); });
  }
  state_->remove(id);
  state_->removed.insert_or_assign(id, std::move(removed));
  return {};
}

Result<void> World::restore(BodyId id) {
  const auto found = state_->removed.find(id);
  if (found == state_->removed.end()) return fail(ErrorKind::bad_input, "cannot restore: no body {} was removed", id);
  const std::size_t joints_before = state_->joints.size();
  state_->joints.insert(state_->joints.end(), found->second.joints.begin(), found->second.joints.end());
  const auto added = state_->add(found->second.description, found->second.spawned, id);
  if (!added) {
    state_->joints.resize(joints_before);
    return fail(added);
  }
  state_->removed.erase(found);
  return {};
}

Result<void> World::place(BodyId id, const Pose& pose) {
  const auto found = state_->store.bodies().find(id);
  if (found == state_->store.bodies().end())
    return fail(ErrorKind::bad_input, "cannot place: the scene has no body {}", id);
  Body& body = found->second;
  const std::string who = "body " + quote(body.description.name);
  if (body.description.path) return fail(ErrorKind::refused, "cannot place {}: it follows a path", who);
  for (const auto* joints : {&state_->joints, &state_->made_joints}) {
    if (std::ranges::any_of(*joints, [id](const auto& joint) { return joint.joins(id); }))
      return fail(ErrorKind::refused, "cannot place {}: a joint holds it; move the joint in the scene's file", who);
  }
  if (!within(pose.position_m, range::kPosition_m))
    return fail(ErrorKind::bad_input, "cannot place {}: its position has to be within {:g} m", who,
                range::kPosition_m.high);
  if (!(norm(pose.rotation) > 0))
    return fail(ErrorKind::bad_input, "cannot place {}: its rotation is 0; qw = 1 is none", who);
  put_at_rest(body.description, pose);
  body.motion = body.start();
  if (!body.waiting) state_->simulation.place(id, body.motion);
  return {};
}

void World::clear_spawned() {
  std::vector<BodyId> spawned;
  for (const auto& [id, body] : state_->store.bodies()) {
    if (body.spawned) spawned.push_back(id);
  }
  for (const BodyId id : spawned) state_->remove(id);
}

void World::clear() {
  while (!state_->store.bodies().empty()) state_->remove(state_->store.bodies().begin()->first);
  state_->removed.clear();
}

Result<void> World::set_object(const SoundingObject& object) {
  if (!object.bank) return fail(ErrorKind::bad_input, "object " + quote(object.name) + " has no bank");
  const auto solids = state_->store.solids_of(object);
  if (!solids) return fail(solids);
  state_->store.put_object(object);
  for (const auto& [id, solid] : *solids) {
    Body& body = state_->store.bodies().at(id);
    body.object = object.number;
    state_->breaking.remove(id);  // its pieces are those of the bank before
    state_->store.reshape(body, solid);
    if (!body.waiting) state_->scene_bodies.put(id, body, solid);
  }
  return {};
}

void World::remove_object(synth::ObjectNumber number) {
  state_->sounds.silence(number);
  state_->breaking.silence(number);
  state_->store.remove_object(number);
}

Result<void> World::push(BodyId id, Vec3 impulse_ns) {
  auto& bodies = state_->store.bodies();
  const auto found = bodies.find(id);
  if (found == bodies.end()) return fail(ErrorKind::bad_input, "cannot push: the scene has no body {}", id);
  Body& body = found->second;
  const std::string who = "body " + quote(body.description.name);
  if (!within(impulse_ns, range::kPush_ns))
    return fail(ErrorKind::bad_input, "cannot push " + who + ": the impulse is not a number or too large");
  if (body.description.fixed) return fail(ErrorKind::refused, "cannot push " + who + ": it is fixed");
  if (body.waiting) return fail(ErrorKind::refused, "cannot push " + who + ": it has not entered the scene yet");
  body.motion.velocity_m_s = body.motion.velocity_m_s + (1 / body.mass.mass_kg) * impulse_ns;
  state_->simulation.set_motion(id, body.motion);
  return {};
}

std::vector<BodyState> World::bodies() const {
  std::vector<BodyState> states;
  for (const auto& [id, body] : state_->store.bodies()) {
    const Motion& motion = body.motion;
    const Vec3 origin = motion.position_m - to_matrix(motion.rotation) * body.mass.center_m;
    states.push_back({id, body.description.name, body.object ? body.description.object : "", origin, motion.rotation,
                      motion.position_m, motion.velocity_m_s, motion.spin_rad_s, body.description.fixed,
                      body.waiting.has_value()});
  }
  return states;
}

std::vector<BodyOutline> World::describe() const {
  std::vector<BodyOutline> outlines;
  for (const auto& [id, body] : state_->store.bodies()) {
    const BodyDescription& d = body.description;
    outlines.push_back({id, d.name, body.object ? d.object : "", d.shape.type, body.size_m, d.fixed});
  }
  return outlines;
}

}  // namespace ringdown::scene
