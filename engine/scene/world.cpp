#include "engine/scene/world.h"

#include "engine/scene/check.h"
#include "engine/scene/contact_rules.h"
#include "engine/scene/rotation.h"
#include "engine/scene/solid.h"
#include "protocol/names.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace ringdown::scene {
namespace {

// A strike weaker than this (a grain of sand from 1 mm) is not worth an event.
constexpr double kSmallestImpulse_ns = 1e-9;

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
  Motion motion;  // the step to come: where contacts are found, and where the body is for everyone outside
  int resets = 0;

  // Between the object's frame and the centre of mass, about which physics turns a body.
  [[nodiscard]] Motion start() const {
    const Vec3 center = description.position_m + to_matrix(normalized(description.rotation)) * mass.center_m;
    return {center, description.rotation, description.velocity_m_s, description.spin_rad_s};
  }
  [[nodiscard]] Vec3 to_object(Vec3 world_point) const {
    return transpose(to_matrix(motion.rotation)) * (world_point - motion.position_m) + mass.center_m;
  }
};

bool within(Vec3 v, const Range& range) { return range.holds(v.x) && range.holds(v.y) && range.holds(v.z); }

bool is_real(const Motion& m) {
  const double turn = norm(m.rotation);
  return is_finite(m.position_m) && turn > 0.5 && turn < 2 && within(m.velocity_m_s, range::kVelocity_m_s) &&
         within(m.spin_rad_s, range::kSpin_rad_s);
}

}  // namespace

struct World::Impl {
  Impl(const SceneDescription& scene, double rate)
      : simulation(scene),
        repeat(scene.contact.minimum_repeat_s),
        step_s(scene.step_s),
        bounce_threshold_m_s(scene.contact.bounce_threshold_m_s),
        sample_rate_hz(rate),
        random(scene.seed) {
    for (const ObjectDescription& object : scene.objects) density_scale[object.name] = object.material.density;
    strikes.reserve(kMostStrikesPerStep);
  }

  [[nodiscard]] const SoundingObject* find(const protocol::ObjectRef& ref) const;
  [[nodiscard]] double scale_of(const std::string& object) const;
  Result<BodyId> add(BodyDescription description, bool spawned);
  Result<BodyId> spawn(const std::optional<protocol::ObjectRef>& object, BodyDescription description);
  void sound(const Touch& touch, protocol::Frame frame);
  void strike(BodyId id, Vec3 world_point, Vec3 world_impulse, double contact_time_s, protocol::Frame frame);
  void let_in(double now_s);
  void check_bodies();
  void remove(BodyId id);
  [[nodiscard]] double time_s() const { return static_cast<double>(steps) * step_s; }

  Simulation simulation;
  RepeatFilter repeat;
  double step_s, bounce_threshold_m_s, sample_rate_hz;
  Random random;
  protocol::Frame start_frame = 0;
  std::int64_t steps = 0;
  BodyId next_id = 0;
  std::map<BodyId, Body> bodies;
  std::vector<SoundingObject> objects;
  std::map<std::string, double> density_scale;
  std::vector<protocol::Event> strikes;
  std::vector<std::string> notices;
  std::size_t dropped_strikes = 0;
};

const SoundingObject* World::Impl::find(const protocol::ObjectRef& ref) const {
  const auto found = std::ranges::find_if(objects, [&](const SoundingObject& object) {
    return ref.number ? object.number == *ref.number : object.name == ref.name;
  });
  return found == objects.end() ? nullptr : &*found;
}

double World::Impl::scale_of(const std::string& object) const {
  const auto found = density_scale.find(object);
  return found == density_scale.end() ? 1 : found->second;
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
  let_in(time_s());
  return id;
}

void World::Impl::let_in(double now_s) {
  for (auto& [id, body] : bodies) {
    if (!body.waiting || body.description.start_s > now_s) continue;
    simulation.put_body(id, *body.waiting, body.motion, body.description.surface, body.description.fixed);
    body.waiting.reset();
  }
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

void World::Impl::sound(const Touch& touch, protocol::Frame frame) {
  if (!(touch.approach_m_s > bounce_threshold_m_s) || !is_finite(touch.impulse_ns)) return;
  if (length(touch.impulse_ns) < kSmallestImpulse_ns) return;
  if (!repeat.admit(touch.body, touch.other, time_s())) return;
  strike(touch.body, touch.point_m, touch.impulse_ns, touch.contact_time_s, frame);
  strike(touch.other, touch.point_m, -1 * touch.impulse_ns, touch.contact_time_s, frame);
}

void World::Impl::strike(BodyId id, Vec3 world_point, Vec3 world_impulse, double contact_time_s,
                         protocol::Frame frame) {
  const auto found = bodies.find(id);
  if (found == bodies.end() || !found->second.object) return;
  if (strikes.size() == kMostStrikesPerStep) {
    ++dropped_strikes;
    return;
  }
  const Body& body = found->second;
  protocol::Event event;
  event.frame = frame;
  event.object = *body.object;
  event.point_m = body.to_object(world_point);
  event.impulse_ns = transpose(to_matrix(body.motion.rotation)) * world_impulse;
  event.contact_time_s = contact_time_s;
  strikes.push_back(event);
}

void World::Impl::check_bodies() {
  std::vector<BodyId> gone;
  for (auto& [id, body] : bodies) {
    if (body.description.fixed || body.waiting) continue;
    body.motion = simulation.motion(id);
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
  for (const StaticDescription& description : scene.statics) impl->simulation.add_static(next_static++, description);
  for (const BodyDescription& body : scene.bodies) {
    if (const auto added = impl->add(body, false); !added) return fail(added.error());
  }
  return World(std::move(impl));
}

void World::set_start_frame(protocol::Frame frame) { impl_->start_frame = frame; }

void World::set_sample_rate(double sample_rate_hz) { impl_->sample_rate_hz = sample_rate_hz; }

StepReport World::step() {
  Impl& w = *impl_;
  w.strikes.clear();
  w.notices.clear();
  w.dropped_strikes = 0;
  const auto frame = w.start_frame + static_cast<protocol::Frame>(std::llround(w.time_s() * w.sample_rate_hz));
  w.let_in(w.time_s());
  for (const Touch& touch : w.simulation.step()) w.sound(touch, frame);
  const std::size_t dropped_contacts = w.simulation.dropped_contacts();
  w.repeat.forget_old(w.time_s());
  ++w.steps;
  w.check_bodies();
  return {w.strikes, w.notices, w.dropped_strikes, dropped_contacts};
}

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
  std::erase_if(impl_->bodies, [this](const auto& entry) {
    if (entry.second.spawned) impl_->simulation.remove_body(entry.first);
    return entry.second.spawned;
  });
}

void World::clear() {
  for (const auto& [id, body] : impl_->bodies) impl_->simulation.remove_body(id);
  impl_->bodies.clear();
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
      w.simulation.put_body(id, solid, body.motion, body.description.surface, body.description.fixed);
    }
  }
  return {};
}

void World::remove_object(protocol::ObjectNumber number) {
  std::erase_if(impl_->objects, [&](const SoundingObject& known) { return known.number == number; });
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
