#include "engine/scene/scene_bodies.h"

#include <utility>

namespace ringdown::scene {
namespace {

SceneDescription with_step(SceneDescription scene, double step_s) {
  scene.step_s = step_s;
  return scene;
}

}  // namespace

SceneBodies::SceneBodies(const SceneDescription& scene, double part_s)
    : store(scene),
      simulation(with_step(scene, part_s)),
      sounds(with_step(scene, part_s)),
      foley(scene.foley.has_value()) {}

void SceneBodies::put(BodyId id, const Body& body, const Solid& solid) {
  const BodyDescription& description = body.description;
  const SoundingObject* object = body.object ? store.find_object(description.object) : nullptr;
  simulation.put_body(id, solid, body.motion, description.surface, description.fixed, description.gravity_factor);
  simulation.set_filter(id, description.filter);
  ContactSide side =
      side_of(description, solid, object ? object->bank.get() : nullptr, store.scale_of(description.object));
  side.object = body.object;
  if (foley && description.path) side.mass = solid.mass;
  sounds.set_side(id, std::move(side));
}

void SceneBodies::remove(BodyId id) {
  simulation.remove_body(id);
  sounds.remove_side(id);
  store.remove(id);
}

}  // namespace ringdown::scene
