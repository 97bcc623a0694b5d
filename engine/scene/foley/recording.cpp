#include "engine/scene/foley/recording.h"

#include "engine/scene/motion_path.h"
#include "engine/scene/rotation.h"
#include "engine/scene/world.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <utility>

namespace ringdown::scene {
namespace {

constexpr double kAnyRate_hz = 48000;  // of the World, whose events are not used

SceneDescription without_breaks(const SceneDescription& scene) {
  SceneDescription whole = scene;
  for (BodyDescription& body : whole.bodies) body.breaks.reset();
  for (EmitterDescription& emitter : whole.emitters) emitter.body.breaks.reset();
  return whole;
}

// The scene with the bodies of its emitters among the others, all in the places where they start.
SceneDescription with_all_bodies(SceneDescription scene, const World& world) {
  for (const EmitterDescription& emitter : scene.emitters) {
    for (std::uint64_t k = 0; k < emitter.count; ++k) {
      BodyDescription body = emitter.body;
      body.name = emitter.name + "-" + std::to_string(k + 1);
      body.start_s = emitter.body.start_s + static_cast<double>(k) * emitter.every_s;
      scene.bodies.push_back(body);
    }
  }
  scene.emitters.clear();
  const std::vector<BodyState> states = world.bodies();
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    scene.bodies[k].scatter_m = 0;
    scene.bodies[k].position_m = states[k].position_m;
    scene.bodies[k].rotation = states[k].rotation;
  }
  return scene;
}

Pose pose_between(const BodyState& a, const BodyState& b, double share) {
  Rotation turn = b.rotation * inverse(a.rotation);
  if (turn.w < 0) turn = Rotation::from_xyzw(-turn.x, -turn.y, -turn.z, -turn.w);
  const Vec3 way = to_rotation_vector(normalized(turn));
  const Rotation rotation = normalized(from_rotation_vector(share * way) * a.rotation);
  // The centre of mass goes straight, not the frame's origin.
  const Vec3 center = a.center_m + share * (b.center_m - a.center_m);
  const Vec3 arm = rotated(inverse(a.rotation), a.center_m - a.position_m);
  return {center - rotated(rotation, arm), rotation};
}

}  // namespace

Result<Recording> record(const SceneDescription& scene, std::span<const SoundingObject> objects, double frames_per_s,
                         const std::function<bool(double)>& go_on) {
  const SceneDescription whole = without_breaks(scene);
  auto world = World::create(whole, objects, kAnyRate_hz);
  if (!world) return fail(world);
  world->number_steps();
  const double wanted = scene.duration_s * frames_per_s + 1;
  if (!(frames_per_s > 0 && wanted <= static_cast<double>(kMaxPathPoses)))
    return fail(ErrorKind::bad_input, "a recording of more than " + std::to_string(kMaxPathPoses) +
                                          " frames is too long; take fewer frames a second, or a part of the scene");
  Recording made{.scene = with_all_bodies(whole, *world)};
  const auto frames = static_cast<std::size_t>(wanted);
  std::vector<std::vector<Pose>> poses;
  std::vector<BodyState> before = world->bodies();  // whose numbers are the indices of their descriptions
  for (const BodyState& state : before) poses.push_back({{state.position_m, state.rotation}});
  double before_s = 0;
  for (std::size_t frame = 1; frame < frames;) {
    const StepReport report = world->step();
    made.contacts.insert(made.contacts.end(), report.contacts.begin(), report.contacts.end());
    made.notices.insert(made.notices.end(), report.notices.begin(), report.notices.end());
    std::vector<BodyState> after = before;
    for (BodyState& state : world->bodies()) after[state.id] = std::move(state);
    for (; frame < frames && static_cast<double>(frame) / frames_per_s <= world->time_s(); ++frame) {
      if (go_on && !go_on(static_cast<double>(frame) / static_cast<double>(frames)))
        return fail(ErrorKind::cancelled, "the recording was stopped");
      const double share = (static_cast<double>(frame) / frames_per_s - before_s) / (world->time_s() - before_s);
      for (std::size_t n = 0; n < after.size(); ++n) poses[n].push_back(pose_between(before[n], after[n], share));
    }
    before = std::move(after);
    before_s = world->time_s();
  }
  for (std::size_t n = 0; n < poses.size(); ++n) {
    BodyDescription& body = made.scene.bodies[n];
    if (body.fixed && !body.path) continue;
    body.fixed = true;
    body.velocity_m_s = body.spin_rad_s = {};
    body.path = std::make_shared<MotionPath>(
        MotionPath{.poses = std::move(poses[n]), .every_s = 1 / frames_per_s, .once = true});
  }
  made.scene.joints.clear();
  return made;
}

}  // namespace ringdown::scene
