#include "engine/scene/world.h"

#include "engine/base/quoted.h"
#include "engine/scene/check.h"
#include "engine/scene/world_impl.h"

#include <algorithm>
#include <utility>

namespace ringdown::scene {

World::World(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;
World::~World() = default;

Result<World> World::create(const SceneDescription& scene, std::span<const SoundingObject> objects,
                            double sample_rate_hz) {
  if (const auto ok = check(scene); !ok) return fail(ok.error());
  if (!(sample_rate_hz >= 1 && sample_rate_hz <= 1e7))
    return fail(ErrorKind::bad_input, "a scene needs a sample rate from 1 to 1e7 Hz");
  auto impl = std::make_unique<Impl>(scene, sample_rate_hz);
  for (const SoundingObject& object : objects) {
    if (!object.bank) return fail(ErrorKind::bad_input, "object " + ringdown::quoted(object.name) + " has no bank");
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

void World::set_start_frame(synth::Frame frame) { impl_->timeline.start = frame; }

void World::set_sample_rate(double sample_rate_hz) { impl_->timeline.sample_rate_hz = sample_rate_hz; }

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

Result<BodyId> World::spawn(BodyDescription body) {
  if (!body.object.empty() && !impl_->find(body.object)) {
    return fail(ErrorKind::bad_input, "cannot spawn: no object " + ringdown::quoted(body.object) + " is loaded");
  }
  body.name += "-" + std::to_string(impl_->next_id);
  return impl_->add(std::move(body), true);
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
  if (!object.bank) return fail(ErrorKind::bad_input, "object " + ringdown::quoted(object.name) + " has no bank");
  std::map<BodyId, Solid> rebuilt;
  for (const auto& [id, body] : w.bodies) {
    if (body.description.object != object.name) continue;
    Result<Solid> solid = make_solid(body.description, object.bank.get(), w.scale_of(object.name));
    if (!solid)
      return fail(solid.error().kind, "body " + ringdown::quoted(body.description.name) + ": " + solid.error().message);
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
    body.size_m = size_of(solid.shape);
    if (body.waiting) {
      body.waiting = solid;
    } else {
      w.put(id, body, solid);
    }
  }
  return {};
}

void World::remove_object(synth::ObjectNumber number) {
  std::erase_if(impl_->objects, [&](const SoundingObject& known) { return known.number == number; });
  impl_->sounding.silence(number);
  for (auto& [id, body] : impl_->bodies) {
    if (body.object == number) body.object.reset();
  }
}

Result<void> World::push(BodyId body, Vec3 impulse_ns) {
  const auto found = impl_->bodies.find(body);
  if (found == impl_->bodies.end())
    return fail(ErrorKind::bad_input, "cannot push: the scene has no body " + std::to_string(body));
  const std::string who = "body " + ringdown::quoted(found->second.description.name);
  if (!within(impulse_ns, range::kPush_ns))
    return fail(ErrorKind::bad_input, "cannot push " + who + ": the impulse is not a number or too large");
  if (found->second.description.fixed) return fail(ErrorKind::refused, "cannot push " + who + ": it is fixed");
  if (found->second.waiting)
    return fail(ErrorKind::refused, "cannot push " + who + ": it has not entered the scene yet");
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

std::vector<BodyOutline> World::describe() const {
  std::vector<BodyOutline> outlines;
  for (const auto& [id, body] : impl_->bodies) {
    const BodyDescription& d = body.description;
    outlines.push_back({id, d.name, body.object ? d.object : "", d.shape.type, body.size_m, d.fixed});
  }
  return outlines;
}

}  // namespace ringdown::scene
