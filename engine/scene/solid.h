// The mass and the collision shape of a body, free of any physics engine. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"
#include "engine/modal/material_scale.h"
#include "engine/scene/description.h"
#include "engine/scene/rotation.h"

#include <array>
#include <cstdint>
#include <vector>

namespace ringdown::scene {

struct RigidMass {
  double mass_kg = 0;
  Vec3 center_m;          // centre of mass, object frame
  Matrix3 inertia_kg_m2;  // about the centre of mass, along the object frame's axes
};

// All coordinates are relative to the centre of mass, along the object frame's axes.
struct CollisionShape {
  ShapeType type = ShapeType::box;
  Vec3 center_m;                                        // centre of a box or sphere
  Vec3 size_m;                                          // box
  double radius_m = 0;                                  // sphere
  std::vector<Vec3> points;                             // convex: corners; trimesh: vertices
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise from outside
};

// Returns the radius of the smallest ball about the origin, the centre of mass, that holds the shape.
double outer_radius(const CollisionShape& shape);

struct Solid {
  RigidMass mass;
  CollisionShape shape;
};

// Makes a body's mass and shape. Mass and inertia come from the bank's massProperties, scaled in material and size, or
// from the body's own density and size; sizes left at 0 come from the bank's surface, scaled. `bank` is null for a
// silent body. A fixed body needs no mass. Fails on anything that a physics engine could not handle: a missing or
// degenerate mass, no surface, no size.
Result<Solid> make_solid(const BodyDescription& body, const modal::Bank* bank, const modal::MaterialScale& scale = {});

// Returns I = R diag(principal moments) R^T, with R from the orientation quaternion.
Matrix3 inertia_tensor(const modal::MassProperties& mass);

}  // namespace ringdown::scene
