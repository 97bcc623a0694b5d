// The three that have to know of every body: the store, the simulation and the sounds of contacts. [one thread at a
// time]
#pragma once

#include "engine/scene/body_store.h"
#include "engine/scene/contact/contact_sounds.h"
#include "engine/scene/ode/simulation.h"

namespace ringdown::scene {

struct SceneBodies {
  BodyStore store;
  Simulation simulation;
  ContactSounds sounds;
  bool foley;  // true if the contacts of bodies that follow a path are recovered from their motion

  // `part_s` is the time between two steps of the simulation.
  SceneBodies(const SceneDescription& scene, double part_s);

  // Lets a body of the store take part, or replaces its mass and shape.
  void put(BodyId id, const Body& body, const Solid& solid);
  void remove(BodyId id);
};

}  // namespace ringdown::scene
