#include "engine/scene/faces.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

// The contact points of two convex bodies that touch in a face are found by clipping.
//
// For each body, face_across() takes the face that looks most directly against the contact normal. If neither face
// agrees with the normal to within kFlat_degrees, the bodies touch at an edge or a corner, and there is no polygon.
// Otherwise the better of the two faces is the floor, and the other is clipped by the planes that stand on the floor's
// edges (cut()). Corners of the remaining polygon that lie below the floor become contact points, raised by half of
// their depth. This is how rigid-body engines make box-box contacts: a reference face and an incident face.
namespace ringdown::scene {
namespace {

const double kFlat = std::cos(kFlat_degrees * std::numbers::pi / 180);

// If two faces are about equally good, the first body's is taken, so that the choice does not change from step to step.
constexpr double kBetter = 1e-3;

// Counter-clockwise about `normal`, without points inside (A. M. Andrew's monotone chain, 1979).
std::vector<Vec3> outline(std::vector<Vec3> points, Vec3 normal) {
  const Vec3 aside = std::abs(normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = cross(aside, normal), v = cross(normal, u);
  std::ranges::sort(points, [&](Vec3 a, Vec3 b) {
    return dot(a, u) < dot(b, u) || (dot(a, u) == dot(b, u) && dot(a, v) < dot(b, v));
  });
  std::vector<Vec3> chain;
  for (int half = 0; half < 2; ++half) {
    const std::size_t start = chain.size();
    for (const Vec3& p : points) {
      while (chain.size() >= start + 2 &&
             dot(cross(chain.back() - chain[chain.size() - 2], p - chain.back()), normal) <= 0) {
        chain.pop_back();
      }
      chain.push_back(p);
    }
    chain.pop_back();
    std::ranges::reverse(points);
  }
  return chain;
}

const Face* face_across(const PosedFaces& body, Vec3 outward) {
  const Vec3 within = transpose(body.rotation) * outward;
  const Face* best = nullptr;
  for (const Face& face : body.faces) {
    if (!best || dot(face.normal, within) > dot(best->normal, within)) best = &face;
  }
  return best;
}

std::vector<Vec3> in_world(const Face& face, const PosedFaces& body) {
  std::vector<Vec3> corners;
  for (const Vec3& corner : face.corners) corners.push_back(body.position_m + body.rotation * corner);
  return corners;
}

// Clips the polygon by the plane through `on` and keeps the inner side (I. E. Sutherland, G. W. Hodgman, 1974).
std::vector<Vec3> cut(std::span<const Vec3> polygon, Vec3 on, Vec3 outward) {
  std::vector<Vec3> kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3 a = polygon[k], b = polygon[(k + 1) % polygon.size()];
    const double beyond_a = dot(outward, a - on), beyond_b = dot(outward, b - on);
    if (beyond_a <= 0) kept.push_back(a);
    if ((beyond_a < 0 && beyond_b > 0) || (beyond_a > 0 && beyond_b < 0)) {
      kept.push_back(a + (beyond_a / (beyond_a - beyond_b)) * (b - a));
    }
  }
  return kept;
}

}  // namespace

// Triangles are merged into faces greedily, the largest first: every triangle within kFlat_degrees of its normal joins
// its face. This is correct only for a convex body, in which equal normals mean one plane.
std::vector<Face> flat_faces(std::span<const Vec3> points, std::span<const std::array<std::uint32_t, 3>> triangles) {
  std::vector<Vec3> areas;
  std::vector<std::size_t> by_size(triangles.size());
  for (const auto& [a, b, c] : triangles) areas.push_back(cross(points[b] - points[a], points[c] - points[a]));
  for (std::size_t k = 0; k < by_size.size(); ++k) by_size[k] = k;
  std::ranges::stable_sort(by_size, std::greater(), [&](std::size_t k) { return length(areas[k]); });
  std::vector<bool> taken(triangles.size());
  std::vector<Face> faces;
  for (const std::size_t seed : by_size) {
    if (taken[seed] || !(length(areas[seed]) > 0)) continue;
    const Vec3 normal = (1 / length(areas[seed])) * areas[seed];
    std::vector<Vec3> corners;
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      if (dot(areas[k], normal) < kFlat * length(areas[k])) continue;
      taken[k] = true;
      for (const std::uint32_t corner : triangles[k]) corners.push_back(points[corner]);
    }
    faces.push_back({normal, outline(std::move(corners), normal)});
  }
  return faces;
}

std::vector<Face> box_faces(Vec3 size_m) {
  const Vec3 half = 0.5 * size_m;
  std::vector<Face> faces;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      std::vector<Vec3> corners;
      for (int k = 0; k < 8; ++k) {
        const Vec3 corner{k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z};
        if (((k >> axis & 1) != 0) == (sign > 0)) corners.push_back(corner);
      }
      const Vec3 normal{axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0};
      faces.push_back({normal, outline(std::move(corners), normal)});
    }
  }
  return faces;
}

FaceContact share_of_faces(const PosedFaces& first, const PosedFaces& second, Vec3 normal) {
  const Face *of_first = face_across(first, -1 * normal), *of_second = face_across(second, normal);
  if (!of_first || !of_second) return {};
  const Vec3 out_of_first = first.rotation * of_first->normal, out_of_second = second.rotation * of_second->normal;
  const double across_first = -dot(out_of_first, normal), across_second = dot(out_of_second, normal);
  if (std::max(across_first, across_second) < kFlat) return {};
  const bool on_second = across_second > across_first + kBetter;
  const std::vector<Vec3> floor = on_second ? in_world(*of_second, second) : in_world(*of_first, first);
  std::vector<Vec3> polygon = on_second ? in_world(*of_first, first) : in_world(*of_second, second);
  const Vec3 up = on_second ? out_of_second : out_of_first;
  for (std::size_t k = 0; k < floor.size() && !polygon.empty(); ++k) {
    polygon = cut(polygon, floor[k], cross(floor[(k + 1) % floor.size()] - floor[k], up));
  }
  FaceContact contact{on_second ? up : -1 * up, {}};
  for (const Vec3& p : polygon) {
    const double depth_m = dot(up, floor.front() - p);
    if (depth_m >= 0) contact.points.push_back({p + (0.5 * depth_m) * up, depth_m});
  }
  return contact;
}

}  // namespace ringdown::scene
