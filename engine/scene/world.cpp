#include "engine/scene/world.h"

#include "engine/scene/check.h"
#include "engine/scene/rotation.h"
#include "engine/scene/solid.h"
#include "protocol/names.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

namespace ringdown::scene {
namespace {

// Numbers from a seed, the same on every machine (Steele, Lea, Flood 2014: SplitMix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  // In [-1, 1).
  double next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return std::ldexp(static_cast<double>((z ^ (z >> 31)) >> 11), -52) - 1;
  }
  Vec3 next_vec3() {
    const double x = next(), y = next(), z = next();
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

struct Body {
  BodyDescription description;  // with its scatter applied
  std::optional<protocol::ObjectNumber> object;
  RigidMass mass;
  bool spawned = false;
  std::optional<Solid> waiting;  // until start_s, when the simulation gets it
  Motion motion;                 // at the end of the last step
  int resets = 0;

  // Between the object's frame and the centre of mass, about which physics turns a body.
  [[nodiscard]] Motion start() const {
    const Vec3 center = description.position_m + to_matrix(normalized(description.rotation)) * mass.center_m;
    return {center, description.rotation, description.velocity_m_s, description.spin_rad_s};
  }
};

bool within(Vec3 v, const Range& range) { return range.holds(v.x) && range.holds(v.y) && range.holds(v.z); }

bool is_real(const Motion& m) {
  const double turn = norm(m.rotation);
  return is_finite(m.position_m) && turn > 0.5 && turn < 2 && within(m.velocity_m_s, range::kVelocity_m_s) &&
         within(m.spin_rad_s, range::kSpin_rad_s);
}

// As many equal parts as it takes; a rounding error more is no reason for another.
int parts_of(double step_s) { return std::max(1, static_cast<int>(std::ceil(step_s / kLongestPart_s - 1e-9))); }

SceneDescription with_step(SceneDescription scene, double step_s) {
  scene.step_s = step_s;
  return scene;
}

struct WaitingJoint {
  BodyId body = 0;
  std::optional<BodyId> other;
  JointDescription description;
};

}  // namespace

struct World::Impl {
  Impl(const SceneDescription& scene, double rate)
      : step_s(scene.step_s),
        parts(parts_of(scene.step_s)),
        part_s(scene.step_s / parts),
        simulation(with_step(scene, part_s)),
        sounding(with_step(scene, part_s)),
        timeline{.sample_rate_hz = rate},
        gravity_m_s2(scene.gravity_m_s2),
        random(scene.seed) {
    for (const ObjectDescription& object : scene.objects) material_scale[object.name] = object.material;
  }

  [[nodiscard]] const SoundingObject* find(const protocol::ObjectRef& ref) const;
  [[nodiscard]] modal::MaterialScale scale_of(const std::string& object) const;
  Result<BodyId> add(BodyDescription description, bool spawned);
  Result<BodyId> spawn(const std::optional<protocol::ObjectRef>& object, BodyDescription description);
  void let_in(double now_s);
  void put(BodyId id, const Body& body, const Solid& solid);
  void note_joints(const SceneDescription& scene);
  Result<void> add_all(const EmitterDescription& emitter);
  void join_those_in();
  void check_bodies();
  void remove(BodyId id);
  void do_part();
  [[nodiscard]] double time_s() const { return static_cast<double>(steps) * step_s + part * part_s; }

  double step_s;
  int parts;  // of each step
  double part_s;
  Simulation simulation;
  Sounding sounding;
  Timeline timeline;
  Vec3 gravity_m_s2;
  Random random;
  std::int64_t steps = 0;
  int part = 0;  // of the step that is being done
  BodyId next_id = 0;
  std::map<BodyId, Body> bodies;
  double next_start_s = 0;  // no waiting body enters before
  std::vector<WaitingJoint> joints;
  std::vector<SoundingObject> objects;
  std::map<std::string, modal::MaterialScale> material_scale;
  std::vector<protocol::Event> events;
  std::vector<Leaning> leanings;  // of the step, as are the next three
  std::vector<std::string> notices;
  std::size_t dropped_events = 0, dropped_contacts = 0;
};

const SoundingObject* World::Impl::find(const protocol::ObjectRef& ref) const {
  const auto found = std::ranges::find_if(objects, [&](const SoundingObject& object) {
    return ref.number ? object.number == *ref.number : object.name == ref.name;
  });
  return found == objects.end() ? nullptr : &*found;
}

modal::MaterialScale World::Impl::scale_of(const std::string& object) const {
  const auto found = material_scale.find(object);
  return found == material_scale.end() ? modal::MaterialScale{} : found->second;
}

Result<BodyId> World::Impl::add(BodyDescription description, bool spawned) {
  const std::string who = "body " + protocol::quoted(description.name) + ": ";
  if (bodies.size() >= kMostBodies) {
    return fail(who + "the scene is full with " + std::to_string(kMostBodies) + " bodies; clear some first");
  }
  if (const auto ok = check(description); !ok) return fail(ok.error());
  const SoundingObject* object = description.object.empty() ? nullptr : find({description.object, {}});
  if (!description.object.empty() && !object) {
    return fail(who + "no object " + protocol::quoted(description.object) + " is loaded");
  }
  Result<Solid> solid = make_solid(description, object ? object->bank.get() : nullptr, scale_of(description.object));
  if (!solid) return fail(who + solid.error().message);
  description.position_m = description.position_m + description.scatter_m * random.next_vec3();
  const BodyId id = next_id++;
  Body body{std::move(description), {}, solid->mass, spawned, std::move(*solid)};
  body.motion = body.start();
  if (object) body.object = object->number;
  bodies.emplace(id, std::move(body));
  next_start_s = 0;
  let_in(time_s());
  return id;
}

void World::Impl::let_in(double now_s) {
  if (now_s < next_start_s) return;
  next_start_s = std::numeric_limits<double>::infinity();
  for (auto& [id, body] : bodies) {
    if (!body.waiting) continue;
    if (body.description.start_s > now_s) {
      next_start_s = std::min(next_start_s, body.description.start_s);
      continue;
    }
    // A part moves by the velocity at its end. Begun half a part early, a fall lies on the true parabola.
    if (!body.description.fixed) body.motion.velocity_m_s = body.motion.velocity_m_s - (0.5 * part_s) * gravity_m_s2;
    put(id, body, *body.waiting);
    body.waiting.reset();
  }
  join_those_in();
}

void World::Impl::put(BodyId id, const Body& body, const Solid& solid) {
  const BodyDescription& description = body.description;
  const SoundingObject* object = body.object ? find({.number = body.object}) : nullptr;
  simulation.put_body(id, solid, body.motion, description.surface, description.fixed);
  Side side = side_of(description, solid, object ? object->bank.get() : nullptr, scale_of(description.object));
  side.object = body.object;
  sounding.set_side(id, std::move(side));
}

// The scene's bodies are numbered in their order.
void World::Impl::note_joints(const SceneDescription& scene) {
  const auto number = [&](const std::string& name) {
    return static_cast<BodyId>(std::ranges::find(scene.bodies, name, &BodyDescription::name) - scene.bodies.begin());
  };
  for (const JointDescription& joint : scene.joints) {
    joints.push_back({number(joint.body), {}, joint});
    if (!joint.other.empty()) joints.back().other = number(joint.other);
  }
}

Result<void> World::Impl::add_all(const EmitterDescription& emitter) {
  BodyDescription body = emitter.body;
  for (std::uint64_t k = 1; k <= emitter.count; ++k) {
    body.name = emitter.name + "-" + std::to_string(k);
    if (const auto added = add(body, false); !added) return fail(added.error());
    body.start_s += emitter.every_s;
  }
  return {};
}

// A joint waits for its bodies.
void World::Impl::join_those_in() {
  std::erase_if(joints, [this](const WaitingJoint& joint) {
    const auto is_in = [this](BodyId id) { return bodies.contains(id) && !bodies.at(id).waiting; };
    if (!is_in(joint.body) || (joint.other && !is_in(*joint.other))) return false;
    simulation.add_joint(joint.body, joint.other, joint.description);
    return true;
  });
}

Result<BodyId> World::Impl::spawn(const std::optional<protocol::ObjectRef>& object, BodyDescription description) {
  if (object) {
    const SoundingObject* known = find(*object);
    if (!known) return fail("cannot spawn: no object " + protocol::quoted(protocol::to_text(*object)) + " is loaded");
    description.object = known->name;
  }
  description.name += "-" + std::to_string(next_id);
  return add(std::move(description), true);
}

void World::Impl::check_bodies() {
  std::vector<BodyId> gone;
  for (const auto& [id, motion] : simulation.moved()) {
    Body& body = bodies.at(id);
    body.motion = motion;
    if (is_real(body.motion) && within(body.motion.position_m, range::kPosition_m)) continue;
    const std::string who = "body " + protocol::quoted(body.description.name);
    if (is_real(body.motion)) {
      notices.push_back(who + " left the scene and was removed");
      gone.push_back(id);
    } else if (body.resets++ < kMostResets) {
      notices.push_back(who + " moved beyond what is real and was put back to its start, at rest");
      body.description.velocity_m_s = body.description.spin_rad_s = {};
      body.motion = body.start();
      simulation.set_motion(id, body.motion);
    } else {
      notices.push_back(who + " kept moving beyond what is real and was removed");
      gone.push_back(id);
    }
  }
  for (const BodyId id : gone) remove(id);
}

void World::Impl::remove(BodyId id) {
  simulation.remove_body(id);
  sounding.remove_side(id);
  std::erase_if(joints, [id](const WaitingJoint& joint) { return joint.body == id || joint.other == id; });
  bodies.erase(id);
}

World::World(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;
World::~World() = default;

Result<World> World::create(const SceneDescription& scene, std::span<const SoundingObject> objects,
                            double sample_rate_hz) {
  if (const auto ok = check(scene); !ok) return fail(ok.error());
  if (!(sample_rate_hz >= 1 && sample_rate_hz <= 1e7)) return fail("a scene needs a sample rate from 1 to 1e7 Hz");
  auto impl = std::make_unique<Impl>(scene, sample_rate_hz);
  for (const SoundingObject& object : objects) {
    if (!object.bank) return fail("object " + protocol::quoted(object.name) + " has no bank");
    impl->objects.push_back(object);
  }
  BodyId next_static = kFirstStatic;
  for (const StaticDescription& description : scene.statics) {
    impl->simulation.add_static(next_static, description);
    impl->sounding.set_side(next_static++, side_of(description));
  }
  impl->note_joints(scene);
  for (const BodyDescription& body : scene.bodies) {
    if (const auto added = impl->add(body, false); !added) return fail(added.error());
  }
  for (const EmitterDescription& emitter : scene.emitters) {
    if (const auto added = impl->add_all(emitter); !added) return fail(added.error());
  }
  return World(std::move(impl));
}

void World::set_start_frame(protocol::Frame frame) { impl_->timeline.start = frame; }

void World::set_sample_rate(double sample_rate_hz) { impl_->timeline.sample_rate_hz = sample_rate_hz; }

// One part of a step: the whole of it, unless the step is long.
void World::Impl::do_part() {
  let_in(time_s());
  const bool asleep = simulation.asleep();
  if (asleep && sounding.quiet()) return;
  const std::span<const Touch> touches = asleep ? std::span<const Touch>() : simulation.step();
  const std::span<const Moved> moved = asleep ? std::span<const Moved>() : simulation.moved();
  const std::span<const protocol::Event> heard = sounding.hear(touches, moved, time_s(), timeline);
  events.insert(events.end(), heard.begin(), heard.end());
  leanings.insert(leanings.end(), sounding.leanings().begin(), sounding.leanings().end());
  dropped_events += sounding.dropped();
  if (asleep) return;
  dropped_contacts += simulation.dropped_contacts();
  check_bodies();
}

StepReport World::step() {
  Impl& w = *impl_;
  w.events.clear();
  w.notices.clear();
  w.leanings.clear();
  w.dropped_events = w.dropped_contacts = 0;
  for (w.part = 0; w.part < w.parts; ++w.part) w.do_part();
  w.part = 0;
  ++w.steps;
  return {w.events, w.leanings, w.notices, w.dropped_events, w.dropped_contacts};
}

bool World::sounds() const {
  return std::ranges::any_of(impl_->bodies, [](const auto& entry) { return entry.second.object.has_value(); });
}

bool World::telling() const { return impl_->sounding.telling(); }

double World::time_s() const { return impl_->time_s(); }
double World::step_s() const { return impl_->step_s; }

Result<BodyId> World::spawn(const protocol::SpawnBox& box) {
  BodyDescription body;
  body.name = "box";
  body.shape = {ShapeType::box, box.size_m, 0};
  body.density_kg_m3 = box.density_kg_m3;
  body.position_m = box.position_m;
  body.velocity_m_s = box.velocity_m_s;
  return impl_->spawn(box.object, std::move(body));
}

Result<BodyId> World::spawn(const protocol::SpawnSphere& sphere) {
  BodyDescription body;
  body.name = "sphere";
  body.shape = {ShapeType::sphere, {}, sphere.radius_m};
  body.density_kg_m3 = sphere.density_kg_m3;
  body.position_m = sphere.position_m;
  body.velocity_m_s = sphere.velocity_m_s;
  return impl_->spawn(sphere.object, std::move(body));
}

void World::clear_spawned() {
  std::vector<BodyId> spawned;
  for (const auto& [id, body] : impl_->bodies) {
    if (body.spawned) spawned.push_back(id);
  }
  for (const BodyId id : spawned) impl_->remove(id);
}

void World::clear() {
  while (!impl_->bodies.empty()) impl_->remove(impl_->bodies.begin()->first);
}

Result<void> World::set_object(const SoundingObject& object) {
  Impl& w = *impl_;
  if (!object.bank) return fail("object " + protocol::quoted(object.name) + " has no bank");
  std::map<BodyId, Solid> rebuilt;
  for (const auto& [id, body] : w.bodies) {
    if (body.description.object != object.name) continue;
    Result<Solid> solid = make_solid(body.description, object.bank.get(), w.scale_of(object.name));
    if (!solid) return fail("body " + protocol::quoted(body.description.name) + ": " + solid.error().message);
    rebuilt.emplace(id, std::move(*solid));
  }
  std::erase_if(w.objects, [&](const SoundingObject& known) { return known.name == object.name; });
  w.objects.push_back(object);
  for (const auto& [id, solid] : rebuilt) {
    Body& body = w.bodies.at(id);
    body.object = object.number;
    // The object's frame stays where it is; the centre of mass moves inside it.
    body.motion.position_m =
        body.motion.position_m + to_matrix(body.motion.rotation) * (solid.mass.center_m - body.mass.center_m);
    body.mass = solid.mass;
    if (body.waiting) {
      body.waiting = solid;
    } else {
      w.put(id, body, solid);
    }
  }
  return {};
}

void World::remove_object(protocol::ObjectNumber number) {
  std::erase_if(impl_->objects, [&](const SoundingObject& known) { return known.number == number; });
  impl_->sounding.silence(number);
  for (auto& [id, body] : impl_->bodies) {
    if (body.object == number) body.object.reset();
  }
}

Result<void> World::push(BodyId body, Vec3 impulse_ns) {
  const auto found = impl_->bodies.find(body);
  if (found == impl_->bodies.end()) return fail("cannot push: the scene has no body " + std::to_string(body));
  const std::string who = "body " + protocol::quoted(found->second.description.name);
  if (!within(impulse_ns, range::kPush_ns))
    return fail("cannot push " + who + ": the impulse is not a number or too large");
  if (found->second.description.fixed) return fail("cannot push " + who + ": it is fixed");
  if (found->second.waiting) return fail("cannot push " + who + ": it has not entered the scene yet");
  Motion& motion = found->second.motion;
  motion.velocity_m_s = motion.velocity_m_s + (1 / found->second.mass.mass_kg) * impulse_ns;
  impl_->simulation.set_motion(body, motion);
  return {};
}

std::vector<BodyState> World::bodies() const {
  std::vector<BodyState> states;
  for (const auto& [id, body] : impl_->bodies) {
    const Motion& motion = body.motion;
    const bool sounds = body.object.has_value();
    const Vec3 origin = motion.position_m - to_matrix(motion.rotation) * body.mass.center_m;
    states.push_back({id, body.description.name, sounds ? body.description.object : "", origin, motion.rotation,
                      motion.position_m, motion.velocity_m_s, motion.spin_rad_s, body.description.fixed,
                      body.waiting.has_value()});
  }
  return states;
}

}  // namespace ringdown::scene
