// The contribution of each of two bodies in contact to the sound of that contact. [any thread]
#pragma once

#include "engine/modal/bank.h"
#include "engine/scene/contact/hertz.h"
#include "engine/scene/contact_point.h"
#include "engine/synth/event.h"

#include <optional>
#include <unordered_map>

namespace ringdown::scene {

struct ContactSide {
  FrictionSurface surface;
  Elastic elastic;
  Curvature curvature;
  std::optional<RigidMass> mass;              // nothing: it does not move
  std::optional<synth::ObjectNumber> object;  // nothing: silent
  bool two_way = false;                       // what touches it feels how it vibrates
  Vec3 center_m;                              // centre of mass in the object's frame
};

// The sides of all bodies and statics in a scene.
using ContactSides = std::unordered_map<BodyId, ContactSide>;
const ContactSide* find(const ContactSides& sides, BodyId id);  // null: none

// A point of the world in the frame of the side's object, whose centre of mass moves by `motion`.
Vec3 to_object(const Motion& motion, const ContactSide& side, Vec3 world_m);

// One over the mass that a side opposes to a push along the unit `normal`; 0 where it does not move. [1/kg]
double inverse_mass(const ContactSide& side, const Motion& motion, Vec3 point_m, Vec3 normal);

// All but the object. The elasticity is that of the surface if it gives one, else of the bank's material, scaled, else
// that of hard stone.
ContactSide side_of(const BodyDescription& body, const Solid& solid, const modal::Bank* bank,
                    const modal::MaterialScale& scale);
ContactSide side_of(const StaticDescription& description);

}  // namespace ringdown::scene
