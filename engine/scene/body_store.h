// Every body of a scene, whether it has entered the scene or still waits for its time, and the objects that bodies may
// play. Knows masses, shapes and where bodies were at the end of the last step, but neither the physics engine nor
// sound. [one thread at a time]
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"
#include "engine/modal/material_scale.h"
#include "engine/scene/contact_point.h"
#include "engine/scene/description.h"
#include "engine/scene/solid.h"
#include "engine/synth/event.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::scene {

// An object as the mixer knows it; bodies that name it play it.
struct SoundingObject {
  std::string name;
  synth::ObjectNumber number = 0;
  std::shared_ptr<const modal::Bank> bank;  // as baked: the scene applies the description's density scale
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
  BodyDescription description;  // its position includes the scatter
  std::optional<synth::ObjectNumber> object;
  RigidMass mass;
  Vec3 size_m;
  bool spawned = false;
  std::optional<Solid> waiting;  // until start_s, when the simulation receives it
  Motion motion;                 // of the centre of mass, at the end of the last step
  int resets = 0;

  // The motion with which the body enters the scene.
  [[nodiscard]] Motion start() const;
};

class BodyStore {
 public:
  explicit BodyStore(const SceneDescription& scene);

  [[nodiscard]] const std::map<BodyId, Body>& bodies() const { return bodies_; }
  [[nodiscard]] std::map<BodyId, Body>& bodies() { return bodies_; }
  [[nodiscard]] BodyId next_id() const { return next_id_; }

  // Adds a body, which waits for its start. Refused when the scene is full, a value is out of range, the object
  // unknown, or mass and shape cannot be made from its bank.
  Result<BodyId> add(BodyDescription description, bool spawned);
  void remove(BodyId id) { bodies_.erase(id); }

  // Adds an object, or replaces the one of that name.
  void put_object(const SoundingObject& object);
  // Removes an object; its bodies become silent.
  void remove_object(synth::ObjectNumber number);
  [[nodiscard]] const SoundingObject* find_object(const std::string& name) const;  // null: unknown
  [[nodiscard]] modal::MaterialScale scale_of(const std::string& object) const;

  // Mass and shape of every body that plays the object, from the bank that `object` has. Changes nothing.
  [[nodiscard]] Result<std::map<BodyId, Solid>> solids_of(const SoundingObject& object) const;

  // Gives a body another mass and shape. The object's frame stays in place; the centre of mass moves within it.
  void reshape(Body& body, const Solid& solid);

 private:
  Random random_;
  BodyId next_id_ = 0;
  std::map<BodyId, Body> bodies_;
  std::vector<SoundingObject> objects_;
  std::map<std::string, modal::MaterialScale> material_scale_;
};

}  // namespace ringdown::scene
