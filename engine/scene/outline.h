// What bodies and statics look like, for those who draw a scene without its file. [any thread]
#pragma once

#include "engine/base/vec3.h"
#include "engine/scene/description.h"
#include "engine/scene/simulation.h"
#include "engine/scene/solid.h"

#include <string>

namespace ringdown::scene {

// A body, whether it has entered the scene yet or not; BodyState (world.h) says where it is.
struct BodyOutline {
  BodyId id = 0;
  std::string name;
  std::string object;  // empty: silent
  ShapeType shape = ShapeType::box;
  Vec3 size_m;  // edges of the shape's bounding box, along the object frame's axes
  bool fixed = false;
};

// Something that never moves. A plane stands at its point nearest to the origin, without a size, and its normal is the
// turned z axis.
struct StaticOutline {
  std::string name;
  StaticType type = StaticType::plane;
  Vec3 size_m, position_m;
  Rotation rotation;
};

Vec3 size_of(const CollisionShape& shape);
StaticOutline outline_of(const StaticDescription& description);

// "box", "sphere", "convex", "trimesh"; "plane", "box": as scene files have them.
std::string to_text(ShapeType shape);
std::string to_text(StaticType type);

}  // namespace ringdown::scene
