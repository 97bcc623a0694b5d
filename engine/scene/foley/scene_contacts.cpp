#include "engine/scene/foley/scene_contacts.h"

#include "engine/scene/foley/guide.h"
#include "engine/scene/motion_path.h"
#include "engine/scene/ode/posed_colliders.h"
#include "engine/scene/pair_filter.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace ringdown::scene {
namespace {

struct Frames {
  double every_s = 0;
  std::size_t count = 0;
};

// The shortest interval and the longest animation of all paths.
Frames frames_of(const BodyStore& store) {
  Frames frames;
  double length_s = 0;
  for (const auto& [id, body] : store.bodies()) {
    const MotionPath* path = body.description.path.get();
    if (!path || path->poses.size() < 2) continue;
    frames.every_s = frames.every_s > 0 ? std::min(frames.every_s, path->every_s) : path->every_s;
    length_s = std::max(length_s, path->every_s * static_cast<double>(path->poses.size() - 1));
  }
  if (frames.every_s > 0) frames.count = static_cast<std::size_t>(std::floor(length_s / frames.every_s + 1.5));
  return frames;
}

// The path with one pose in each of the scene's frames.
MotionPath in_frames(const MotionPath& path, const Pose& start, const Frames& frames) {
  if (path.every_s == frames.every_s && path.poses.size() == frames.count) return path;
  MotionPath result{.every_s = frames.every_s};
  for (std::size_t k = 0; k < frames.count; ++k) {
    const Motion motion = motion_on(path, start, {}, static_cast<double>(k) * frames.every_s, frames.every_s);
    result.poses.push_back({motion.position_m, motion.rotation});
  }
  return result;
}

}  // namespace

Result<Recovery> recover_contacts(const SceneDescription& scene, const BodyStore& store) {
  const Frames frames = frames_of(store);
  PosedColliders colliders;
  PairFilter filter;
  std::vector<FoleyBody> moving, fixed;
  std::vector<GuidedBody> solids, fixed_solids;
  for (const auto& [id, body] : store.bodies()) {
    const BodyDescription& d = body.description;
    if (!d.fixed) continue;
    const SoundingObject* object = store.find_object(d.object);
    const auto solid = make_solid(d, object ? object->bank.get() : nullptr, store.scale_of(d.object));
    if (!solid) return fail(solid);
    colliders.add(id, *solid);
    filter.set(id, d.filter);
    FoleyBody made{.id = id, .name = d.name, .surface = d.surface, .radius_m = outer_radius(solid->shape)};
    GuidedBody guided{*solid, d.filter, d.gravity_factor};
    if (!d.path || frames.count < 2) {
      made.motion = KeyedMotion(body.start());
      fixed.push_back(std::move(made));
      fixed_solids.push_back(std::move(guided));
      continue;
    }
    const auto from = static_cast<std::size_t>(std::ceil(d.start_s / frames.every_s - 1e-6));
    made.motion = KeyedMotion(in_frames(*d.path, {d.position_m, d.rotation}, frames), solid->mass,
                              d.gravity_factor * scene.gravity_m_s2, from, *scene.foley);
    moving.push_back(std::move(made));
    solids.push_back(std::move(guided));
  }
  BodyId next = kFirstStatic;
  for (const StaticDescription& description : scene.statics) {
    colliders.add(next, description);
    filter.set(next, description.filter);
    fixed.push_back({.id = next++, .name = description.name, .surface = description.surface});
    fixed_solids.push_back({.filter = description.filter});
  }
  const auto number = [&](const std::string& name) {
    return static_cast<BodyId>(std::ranges::find(scene.bodies, name, &BodyDescription::name) - scene.bodies.begin());
  };
  for (const JointDescription& joint : scene.joints) {
    if (!joint.collides && !joint.other.empty()) filter.part(number(joint.body), number(joint.other));
  }
  moving.insert(moving.end(), std::make_move_iterator(fixed.begin()), std::make_move_iterator(fixed.end()));
  solids.insert(solids.end(), std::make_move_iterator(fixed_solids.begin()),
                std::make_move_iterator(fixed_solids.end()));
  Recovery recovery = recover(std::move(moving), colliders, filter, *scene.foley, length(scene.gravity_m_s2),
                              frames.every_s, frames.count);
  guide(scene, solids, frames.count, recovery);
  return recovery;
}

}  // namespace ringdown::scene
