#include "engine/base/quoted.h"
#include "engine/scene/check.h"
#include "engine/scene/world_impl.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace ringdown::scene {
namespace {

bool is_real(const Motion& m) {
  const double turn = norm(m.rotation);
  return is_finite(m.position_m) && turn > 0.5 && turn < 2 && within(m.velocity_m_s, range::kVelocity_m_s) &&
         within(m.spin_rad_s, range::kSpin_rad_s);
}

// As many equal parts as it takes; a rounding error more is no reason for another.
int parts_of(double step_s) { return std::max(1, static_cast<int>(std::ceil(step_s / kMaxPart_s - 1e-9))); }

SceneDescription with_step(SceneDescription scene, double step_s) {
  scene.step_s = step_s;
  return scene;
}

}  // namespace

World::Impl::Impl(const SceneDescription& scene, double rate)
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

const SoundingObject* World::Impl::find(const std::string& name) const {
  const auto found = std::ranges::find(objects, name, &SoundingObject::name);
  return found == objects.end() ? nullptr : &*found;
}

modal::MaterialScale World::Impl::scale_of(const std::string& object) const {
  const auto found = material_scale.find(object);
  return found == material_scale.end() ? modal::MaterialScale{} : found->second;
}

Result<BodyId> World::Impl::add(BodyDescription description, bool spawned) {
  const std::string who = "body " + ringdown::quoted(description.name) + ": ";
  if (bodies.size() >= kMaxBodies) {
    return fail(ErrorKind::refused,
                who + "the scene is full with " + std::to_string(kMaxBodies) + " bodies; clear some first");
  }
  if (const auto ok = check(description); !ok) return fail(ok.error());
  const SoundingObject* object = description.object.empty() ? nullptr : find(description.object);
  if (!description.object.empty() && !object) {
    return fail(ErrorKind::bad_input, who + "no object " + ringdown::quoted(description.object) + " is loaded");
  }
  Result<Solid> solid = make_solid(description, object ? object->bank.get() : nullptr, scale_of(description.object));
  if (!solid) return fail(solid.error().kind, who + solid.error().message);
  description.position_m = description.position_m + description.scatter_m * random.next_vec3();
  const BodyId id = next_id++;
  const Vec3 size_m = size_of(solid->shape);
  Body body{std::move(description), {}, solid->mass, size_m, spawned, std::move(*solid)};
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
  const SoundingObject* object = body.object ? find(description.object) : nullptr;
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

void World::Impl::check_bodies() {
  std::vector<BodyId> gone;
  for (const auto& [id, motion] : simulation.moved()) {
    Body& body = bodies.at(id);
    body.motion = motion;
    if (is_real(body.motion) && within(body.motion.position_m, range::kPosition_m)) continue;
    const std::string who = "body " + ringdown::quoted(body.description.name);
    if (is_real(body.motion)) {
      notices.push_back(who + " left the scene and was removed");
      gone.push_back(id);
    } else if (body.resets++ < kMaxResets) {
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

// One part of a step: the whole of it, unless the step is long.
void World::Impl::do_part() {
  let_in(time_s());
  const bool asleep = simulation.asleep();
  if (asleep && sounding.quiet()) return;
  const std::span<const Touch> touches = asleep ? std::span<const Touch>() : simulation.step();
  const std::span<const Moved> moved = asleep ? std::span<const Moved>() : simulation.moved();
  const std::span<const synth::Event> heard = sounding.hear(touches, moved, time_s(), timeline);
  events.insert(events.end(), heard.begin(), heard.end());
  leanings.insert(leanings.end(), sounding.leanings().begin(), sounding.leanings().end());
  dropped_events += sounding.dropped();
  if (asleep) return;
  dropped_contacts += simulation.dropped_contacts();
  check_bodies();
}

}  // namespace ringdown::scene
