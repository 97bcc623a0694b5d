#include "engine/mesh/surface/surface_distance.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Object.h>
#include <CGAL/Simple_cartesian.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <vector>

namespace ringdown::mesh {
namespace {

using DistanceKernel = CGAL::Simple_cartesian<double>;
using Point = DistanceKernel::Point_3;
using Triangle = DistanceKernel::Triangle_3;
using Primitive = CGAL::AABB_triangle_primitive<DistanceKernel, std::vector<Triangle>::const_iterator>;
using Boxes = CGAL::AABB_tree<CGAL::AABB_traits<DistanceKernel, Primitive>>;

}  // namespace

struct SurfaceRays::Tree {
  std::vector<Triangle> triangles;
  Boxes boxes;
};

SurfaceRays::SurfaceRays(const TriangleMesh& surface) : tree_(std::make_unique<Tree>()) {
  const auto point = [&surface](std::int32_t n) {
    return Point(surface.nodes(n, 0), surface.nodes(n, 1), surface.nodes(n, 2));
  };
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto row = surface.triangles.row(t);
    tree_->triangles.emplace_back(point(row[0]), point(row[1]), point(row[2]));
  }
  tree_->boxes.insert(tree_->triangles.cbegin(), tree_->triangles.cend());
  tree_->boxes.build();
  tree_->boxes.accelerate_distance_queries();
}

SurfaceRays::~SurfaceRays() = default;
SurfaceRays::SurfaceRays(SurfaceRays&&) noexcept = default;

Eigen::RowVector3d SurfaceRays::nearest(const Eigen::RowVector3d& point) const {
  const Point found = tree_->boxes.closest_point({point[0], point[1], point[2]});
  return {found.x(), found.y(), found.z()};
}

Eigen::Index SurfaceRays::nearest_triangle(const Eigen::RowVector3d& point) const {
  const auto found = tree_->boxes.closest_point_and_primitive({point[0], point[1], point[2]}).second;
  return found - tree_->triangles.cbegin();
}

double SurfaceRays::inward(Eigen::Index triangle) const {
  const Triangle& from = tree_->triangles[static_cast<std::size_t>(triangle)];
  const auto normal = CGAL::cross_product(from[1] - from[0], from[2] - from[0]);
  const double none = std::numeric_limits<double>::max();
  if (!(normal.squared_length() > 0)) return none;
  const auto way = -normal / std::sqrt(normal.squared_length());  // a tiny one would vanish beside the coordinates
  const Point middle = CGAL::centroid(from);
  const auto self = tree_->triangles.cbegin() + triangle;
  const auto hit = tree_->boxes.first_intersection(DistanceKernel::Ray_3(middle, way),
                                                   [self](const auto& primitive) { return primitive == self; });
  if (!hit) return none;
  const CGAL::Object met(hit->first);  // made of the variant that CGAL 5 takes from Boost, and CGAL 6 from std
  const Point* at = CGAL::object_cast<Point>(&met);
  return at ? std::sqrt(CGAL::squared_distance(middle, *at)) : none;
}

std::optional<SurfaceRays::Hit> SurfaceRays::first(const Eigen::RowVector3d& point,
                                                   const Eigen::RowVector3d& direction) const {
  if (!(direction.squaredNorm() > 0)) return std::nullopt;
  const Point from(point[0], point[1], point[2]);
  const auto hit = tree_->boxes.first_intersection(
      DistanceKernel::Ray_3(from, DistanceKernel::Vector_3(direction[0], direction[1], direction[2])));
  if (!hit) return std::nullopt;
  const CGAL::Object met(hit->first);
  const Point* at = CGAL::object_cast<Point>(&met);
  if (!at) return std::nullopt;
  const Triangle& triangle = *hit->second;
  const auto normal = CGAL::cross_product(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  return Hit{std::sqrt(CGAL::squared_distance(from, *at)),
             Eigen::RowVector3d(normal.x(), normal.y(), normal.z()).normalized()};
}

double SurfaceRays::along(const Eigen::RowVector3d& point, const Eigen::RowVector3d& direction,
                          const Eigen::RowVector3d& outward) const {
  const std::optional<Hit> hit = first(point, direction);
  return hit && hit->normal.dot(outward) > 0 ? hit->distance_m : std::numeric_limits<double>::max();
}

// The wall is measured by rays: from the middle of a triangle along its inward normal to the next triangle. kRays rays
// are spread evenly over the area, one in each equal share of it, so the figure does not depend on how the surface is
// cut into triangles. The result is the quantile kMinThicknessShare of the lengths rather than the minimum, because a
// ray that starts beside an edge may be arbitrarily short, however thick the body is.
double wall_thickness(const TriangleMesh& surface) {
  constexpr int kRays = 2000;
  const SurfaceRays rays(surface);
  std::vector<double> up_to;  // area
  double area = 0;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto row = surface.triangles.row(t);
    const Eigen::RowVector3d a = surface.nodes.row(row[0]), b = surface.nodes.row(row[1]),
                             c = surface.nodes.row(row[2]);
    up_to.push_back(area += 0.5 * (b - a).cross(c - a).norm());
  }
  std::vector<double> lengths;
  for (int ray = 0; ray < kRays && area > 0; ++ray) {
    const double share = (ray + 0.5) / kRays * area;
    const auto found = std::upper_bound(up_to.begin(), up_to.end(), share) - up_to.begin();
    const double length = rays.inward(std::min<std::ptrdiff_t>(found, surface.triangles.rows() - 1));
    if (length < std::numeric_limits<double>::max()) lengths.push_back(length);
  }
  if (lengths.empty()) return 0;
  const auto low =
      lengths.begin() + static_cast<std::ptrdiff_t>(kMinThicknessShare * static_cast<double>(lengths.size()));
  std::nth_element(lengths.begin(), low, lengths.end());
  return *low;
}

}  // namespace ringdown::mesh
