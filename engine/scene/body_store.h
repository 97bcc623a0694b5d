// All bodies of a scene, those still waiting for their start time included, and the objects that bodies may play. Knows
// masses, shapes and the motion at the end of the last step, but neither the physics engine nor sound. [one thread at a
// time]
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"
#include "engine/modal/material_scale.h"
#include "engine/scene/contact_point.h"
#include "engine/scene/description.h"
#include "engine/scene/solid.h"
#include "engine/synth/events/event.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::modal {
class StrikeMap;  // strike_map.h
}
namespace ringdown::breaking {
class PieceSet;  // piece_set.h
}

namespace ringdown::scene {

// An object that the mixer plays. Bodies refer to objects by name.
struct SoundingObject {
  std::string name;
  synth::ObjectNumber number = 0;
  std::shared_ptr<const modal::Bank> bank;  // unscaled; the scene applies the description's density scale
  // For bodies that break; optional, made from the bank if absent: the bank's map, and the pieces of each pattern in
  // the scaled material.
  std::shared_ptr<const modal::StrikeMap> map = {};
  std::vector<std::shared_ptr<const breaking::PieceSet>> pieces = {};
};

// Pseudo-random numbers that are the same on every machine (Steele, Lea, Flood 2014: SplitMix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double next();  // in [-1, 1)
  Vec3 next_vec3();

 private:
  std::uint64_t state_;
};

struct Body {
  BodyDescription description;  // the position includes the scatter
  std::optional<synth::ObjectNumber> object;
  RigidMass mass;
  Vec3 size_m;
  bool spawned = false;
  std::optional<Solid> waiting;  // mass and shape of a body that waits for its start_s; empty afterwards
  Motion motion;                 // of the centre of mass, at the end of the last step
  int resets = 0;

  // The motion with which the body enters the scene.
  [[nodiscard]] Motion start() const;
};

// Lets a body begin in this pose of its object's frame, exactly there and at rest.
void put_at_rest(BodyDescription& body, const Pose& pose);

class BodyStore {
 public:
  explicit BodyStore(const SceneDescription& scene);

  [[nodiscard]] const std::map<BodyId, Body>& bodies() const { return bodies_; }
  [[nodiscard]] std::map<BodyId, Body>& bodies() { return bodies_; }
  [[nodiscard]] BodyId next_id() const { return next_id_; }

  // Adds a body, which waits for its start. Fails if the scene is full, a value is out of range, the object is unknown,
  // or mass and shape cannot be made from its bank. Without `id` it gets a new number.
  Result<BodyId> add(BodyDescription description, bool spawned, std::optional<BodyId> id = {});
  // Adds a body that is in the scene at once, in any number, and is gone with the spawned ones. It needs no checks: it
  // is a piece of another one.
  BodyId add_moving(const BodyDescription& description, const Solid& solid, const Motion& motion);
  void remove(BodyId id) { bodies_.erase(id); }

  // Adds an object, or replaces the object with that name.
  void put_object(const SoundingObject& object);
  // Removes an object; its bodies become silent.
  void remove_object(synth::ObjectNumber number);
  [[nodiscard]] const SoundingObject* find_object(const std::string& name) const;  // null: unknown
  [[nodiscard]] modal::MaterialScale scale_of(const std::string& object) const;

  // Computes mass and shape of every body that plays the object, from the bank in `object`. Changes nothing.
  [[nodiscard]] Result<std::map<BodyId, Solid>> solids_of(const SoundingObject& object) const;

  // Replaces a body's mass and shape. The object's frame stays in place; the centre of mass moves within it.
  void reshape(Body& body, const Solid& solid);

 private:
  Random random_;
  BodyId next_id_ = 0;
  std::map<BodyId, Body> bodies_;
  std::vector<SoundingObject> objects_;
  std::map<std::string, modal::MaterialScale> material_scale_;
};

}  // namespace ringdown::scene
