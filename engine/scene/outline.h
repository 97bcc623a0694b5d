// The appearance of bodies and statics, for programs that draw a scene without its file. [any thread]
#pragma once

#include "engine/base/vec3.h"
#include "engine/scene/contact_point.h"
#include "engine/scene/description.h"
#include "engine/scene/solid.h"

#include <string>

namespace ringdown::scene {

// The appearance of a body, whether or not it has entered the scene; BodyState (world.h) has its position.
struct BodyOutline {
  BodyId id = 0;
  std::string name;
  std::string object;  // empty: silent
  ShapeType shape = ShapeType::box;
  Vec3 size_m;  // edges of the shape's bounding box, along the object frame's axes
  bool fixed = false;
};

// A static. The position of a plane is its point nearest to the origin, its size is 0, and its normal is the rotated z
// axis.
struct StaticOutline {
  std::string name;
  StaticType type = StaticType::plane;
  Vec3 size_m, position_m;
  Rotation rotation;
};

Vec3 size_of(const CollisionShape& shape);
StaticOutline outline_of(const StaticDescription& description);

// Returns the names used in scene files: "box", "sphere", "convex", "trimesh"; "plane", "box".
std::string to_text(ShapeType shape);
std::string to_text(StaticType type);

}  // namespace ringdown::scene
