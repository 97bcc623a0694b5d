#include "engine/scene/outline.h"

#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::scene {
namespace {

Vec3 size_of(const std::vector<Vec3>& points) {
  if (points.empty()) return {};
  Vec3 low = points.front(), high = low;
  for (const Vec3& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return high - low;
}

// The shortest turn that takes z to a unit vector.
Rotation turn_to(Vec3 normal) {
  const Vec3 axis = cross({0, 0, 1}, normal);
  if (length(axis) == 0) return normal.z > 0 ? Rotation{} : about({1, 0, 0}, std::numbers::pi);
  return about(axis, std::atan2(length(axis), normal.z));
}

}  // namespace

Vec3 size_of(const CollisionShape& shape) {
  if (shape.type == ShapeType::box) return shape.size_m;
  if (shape.type == ShapeType::sphere) return 2 * shape.radius_m * Vec3{1, 1, 1};
  return size_of(shape.points);
}

StaticOutline outline_of(const StaticDescription& description) {
  StaticOutline outline{.name = description.name, .type = description.type};
  if (description.type == StaticType::plane) {
    const Vec3 normal = (1 / length(description.normal)) * description.normal;
    outline.position_m = description.offset_m * normal;
    outline.rotation = turn_to(normal);
  } else {
    outline.size_m = description.size_m;
    outline.position_m = description.position_m;
    outline.rotation = normalized(description.rotation);
  }
  return outline;
}

std::string to_text(ShapeType shape) {
  switch (shape) {
    case ShapeType::box:
      return "box";
    case ShapeType::sphere:
      return "sphere";
    case ShapeType::convex:
      return "convex";
    case ShapeType::trimesh:
      break;
  }
  return "trimesh";
}

std::string to_text(StaticType type) { return type == StaticType::plane ? "plane" : "box"; }

}  // namespace ringdown::scene
