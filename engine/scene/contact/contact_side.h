// One of two bodies in contact, with all that the contact's sound depends on. [any thread]
#pragma once

#include "engine/modal/bank.h"
#include "engine/scene/contact/hertz.h"
#include "engine/scene/contact_point.h"
#include "engine/synth/events/event.h"

#include <optional>
#include <unordered_map>
#include <vector>

namespace ringdown::scene {

struct ContactSide {
  FrictionSurface surface;
  Elastic elastic;
  Curvature curvature;
  std::optional<RigidMass> mass;              // nothing: immovable
  std::optional<synth::ObjectNumber> object;  // nothing: silent
  bool breaks = false;                        // whether its blows are judged (ContactSounds::judge_by())
  std::vector<Vec3> corners_m;                // of a body that breaks: its shape's corners, about the centre of mass
  bool two_way = false;                       // whether contacts feel the object's vibration
  Vec3 center_m;                              // centre of mass in the object's frame
};

// Sides of all bodies and statics in a scene.
using ContactSides = std::unordered_map<BodyId, ContactSide>;
const ContactSide* find(const ContactSides& sides, BodyId id);  // null: none

// Converts a point of the world to the frame of the side's object. `motion` is that of the object's centre of mass.
Vec3 to_object(const Motion& motion, const ContactSide& side, Vec3 world_m);

// Returns one over the side's effective mass against a push along the unit `normal`; 0 if it cannot move. [1/kg]
double inverse_mass(const ContactSide& side, const Motion& motion, Vec3 point_m, Vec3 normal);

// A place where a side is pushed along a unit normal, in the world.
struct PushedPlace {
  Vec3 point_m, normal;
};
// Returns the velocity that a push of 1 N s gives the side at another place, along that place's normal. [1/kg]
double inverse_mass(const ContactSide& side, const Motion& motion, const PushedPlace& at, const PushedPlace& push);

// Returns a side without its object. The elasticity is that of the surface if it gives one, else that of the bank's
// material, scaled, else that of hard stone.
ContactSide side_of(const BodyDescription& body, const Solid& solid, const modal::Bank* bank,
                    const modal::MaterialScale& scale);
ContactSide side_of(const StaticDescription& description);

}  // namespace ringdown::scene
