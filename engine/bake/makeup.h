// A Makeup says what a body is made of beyond one isotropic material, and what holds it. [any thread]
//
// All of it is optional: a Makeup with nothing in it is a free body of one isotropic material. Lengths are metres of
// the object as it is baked.
#pragma once

#include "engine/base/vec3.h"
#include "engine/modal/bank.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::bake {

// Which way a material's axes lie (modal/orthotropy.h). Straight: axis 1 lies along `along`, and axis 2 along `radial`,
// made square to it. With an axis, axis 2 points away from it everywhere, and axis 1 runs along it, as in a pole with
// its pith there, or around it, as in a wound tube (`winds`).
struct Grain {
  Vec3 along = {1, 0, 0};
  std::optional<Vec3> radial;  // needed unless the material is alike in all directions across its grain
  std::optional<Vec3> axis;
  Vec3 through_m;  // a point of the axis
  bool winds = false;
};

// A part of the body's surface: its faces whose nodes all lie in a box or on a plane, or a named group of the mesh.
struct Place {
  std::optional<std::array<Vec3, 2>> box_m;  // two opposite corners
  std::optional<std::array<Vec3, 2>> plane;  // a point [m] and a normal
  std::string group;
};

enum class SupportKind {
  kClamped,  // nothing moves
  kSlides,   // flat; moves along itself only
  kSprings,  // rests on springs and dampers, spread over its area
  kPoints,   // cords, felt or fingers touch it at points
};

struct Support {
  SupportKind kind = SupportKind::kClamped;
  Place place;                      // of all but points
  std::vector<Vec3> points_m;       // of points: where they are, on the surface or near it
  double point_damping_ns_m = 0;    // of each point, in all directions
  double point_mass_kg = 0;         // what moves with each point
  double stiffness_n_m3 = 0;        // along the normal: newtons for each metre and each square metre
  double stiffness_along_n_m3 = 0;  // along the surface
  double damping_ns_m3 = 0;         // in all directions
  double loss_factor = 0;           // of the springs
  // True if the body moves as if it were free, but for what it loses.
  [[nodiscard]] bool only_damps() const;
};

struct GluedMass {
  Place place;
  double mass_kg = 0;  // spread over the place; it has no stiffness
};

// The elements of a group of the mesh, in a material of their own. A closed surface inside the body's makes a group of
// what it encloses (mesh/parted_surface.h).
struct Part {
  std::string group;
  std::string surface;       // its file as the object's says it; empty: the mesh has the group
  modal::Material material;  // its name at first; bake_object() looks it up
  std::optional<Grain> grain;
};

struct Makeup {
  std::optional<Grain> grain;  // of what belongs to no part
  std::vector<Part> parts;
  std::vector<Support> supports;
  std::vector<GluedMass> masses;
  [[nodiscard]] bool plain() const { return !grain && parts.empty() && supports.empty() && masses.empty(); }
  // True if its modes are those of a free body of one isotropic material: what supports there are only damp it.
  [[nodiscard]] bool moves_freely() const;
};

// The makeup of an object whose lengths are `scale` times as large.
Makeup scaled(Makeup makeup, double scale);

}  // namespace ringdown::bake
