// What one of two bodies that touch brings to the sound of it. [any thread]
#pragma once

#include "engine/modal/bank.h"
#include "engine/scene/hertz.h"
#include "engine/synth/event.h"

#include <optional>

namespace ringdown::scene {

struct Side {
  Surface surface;
  Elastic elastic;
  Curvature curvature;
  std::optional<RigidMass> mass;              // none: it does not give way
  std::optional<synth::ObjectNumber> object;  // none: it is silent
  Vec3 center_m;                              // centre of mass in the object's frame
};

// Without its object. Its elasticity is its own word, or its bank's material as the scene scales it, or hard stone's.
Side side_of(const BodyDescription& body, const Solid& solid, const modal::Bank* bank,
             const modal::MaterialScale& scale);
Side side_of(const StaticDescription& description);

}  // namespace ringdown::scene
