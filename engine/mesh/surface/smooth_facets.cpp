#include "engine/mesh/surface/smooth_facets.h"

#include "engine/mesh/surface/remesh.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

// A quadratic patch over each facet
//
// Where a surface passes through the corners x_i of a facet with normals n_i there, it lies
//
//   h = 1/2 sum over the sides ij of b_i b_j (n_j - n_i) . (x_j - x_i)
//
// above the facet at the barycentric coordinates b, exactly for a quadratic surface: along a side of length L, on which
// the normal turns by a, that is the sagitta a L / 8 in the middle.
//
// The normal at a corner is the mean over the corner's triangles on this side of sharp edges, weighted by their angles
// there. Triangles much smaller than the facet have less weight: a large flat face next to a narrow rounded edge is
// flat, though its corners lie on the rounding. The ratio of areas is squared, so that the rise of such a face does not
// exceed that of the rounding.
namespace ringdown::mesh {
namespace {

constexpr std::size_t kMaxFan = 500;    // triangles at a node; with more, the facets there count as flat
constexpr double kSimilarSize = 0.5;    // ratio of areas from which a neighbour has full weight
constexpr double kTimesMedian = 3;      // largest angle within a curved surface, in units of the typical angle
constexpr double kOnePlane_rad = 2e-3;  // radians between neighbours in one plane

}  // namespace

SmoothFacets::SmoothFacets(const TriangleMesh& surface)
    : surface_(surface), normals_(surface.triangles.rows(), 3), bulges_(surface.triangles.rows()) {
  const auto angle_at = [this](Eigen::Index t, int i) {
    const Eigen::Vector3d a = corner(t, (i + 1) % 3) - corner(t, i), b = corner(t, (i + 2) % 3) - corner(t, i);
    return std::atan2(a.cross(b).norm(), a.dot(b));
  };
  std::vector<double> areas;
  std::vector<std::array<double, 3>> angles;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const Eigen::Vector3d twice = (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
    areas.push_back(0.5 * twice.norm());
    normals_.row(t) = is_degenerate(surface, t) ? Eigen::Vector3d(0, 0, 0) : twice.normalized();
    angles.push_back({angle_at(t, 0), angle_at(t, 1), angle_at(t, 2)});
  }
  const TriangleFans fans(surface);
  const std::vector<double> smooth = min_smooth_cosines(fans);
  const auto normal_at = [&](Eigen::Index t, int i) {
    const std::int32_t node = surface.triangles(t, i);
    const auto fan = fans.at(node);
    Eigen::RowVector3d sum = normals_.row(t) * 1e-12;
    if (fan.size() > kMaxFan) return Eigen::RowVector3d(normals_.row(t));
    for (const std::int32_t other : fan) {
      if (normals_.row(other).dot(normals_.row(t)) < smooth[static_cast<std::size_t>(node)]) continue;
      const auto row = surface.triangles.row(other);
      const int place = row[0] == node ? 0 : row[1] == node ? 1 : 2;
      const double size =
          std::min(1.0, areas[static_cast<std::size_t>(other)] / (kSimilarSize * areas[static_cast<std::size_t>(t)]));
      sum +=
          size * size * angles[static_cast<std::size_t>(other)][static_cast<std::size_t>(place)] * normals_.row(other);
    }
    return Eigen::RowVector3d(sum.normalized());
  };
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    Eigen::Vector3d& bulge = bulges_[static_cast<std::size_t>(t)];
    bulge.setZero();
    if (normals_.row(t).isZero(0)) continue;
    const std::array<Eigen::RowVector3d, 3> at = {normal_at(t, 0), normal_at(t, 1), normal_at(t, 2)};
    for (int i = 0; i < 3; ++i) {  // side i lies opposite to corner i
      const int a = (i + 1) % 3, b = (i + 2) % 3;
      bulge[i] = 0.5 * (at[b] - at[a]).dot((corner(t, b) - corner(t, a)).transpose());
    }
  }
}

// Programs facet curves at about equal angles. If most edges are blunt, as on a finely turned body, edges that are
// several times sharper are edges of the body, such as the rings where its profile has corners. Scanners make facets of
// about equal lengths, so where a body bends most, as at an animal's ears, all edges are several times sharper than
// most edges elsewhere. So an edge of the body must also be several times sharper than most edges around it.
std::vector<double> SmoothFacets::min_smooth_cosines(const TriangleFans& fans) const {
  const double sharp = kSharpAngle_deg * std::numbers::pi / 180;
  const auto middle_of = [](std::vector<double>& angles) {
    if (angles.empty()) return 0.0;
    const auto middle = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2);
    std::nth_element(angles.begin(), middle, angles.end());
    return *middle;
  };
  const std::vector<EdgeUse> edges =
      edges_of(surface_, std::vector<bool>(static_cast<std::size_t>(surface_.triangles.rows()), true));
  std::vector<double> angles;
  std::vector<std::array<double, 3>> of_triangle(bulges_.size(), {0, 0, 0});  // 0: no such edge
  for (std::size_t first = 0, last; first < edges.size(); first = last) {
    last = end_of_edge(edges, first);
    if (last - first != 2) continue;
    const Eigen::RowVector3d a = normals_.row(edges[first].triangle), b = normals_.row(edges[first + 1].triangle);
    const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
    if (!(angle > kOnePlane_rad && angle < sharp)) continue;
    angles.push_back(angle);
    for (std::size_t e = first; e < last; ++e) {
      std::array<double, 3>& own = of_triangle[static_cast<std::size_t>(edges[e].triangle)];
      *std::find(own.begin(), own.end(), 0.0) = angle;
    }
  }
  const double everywhere = angles.empty() ? sharp : middle_of(angles);
  std::vector<double> cosines;
  for (std::int32_t node = 0; node < surface_.nodes.rows(); ++node) {
    std::vector<double> around;
    if (fans.at(node).size() <= kMaxFan) {
      for (const std::int32_t t : fans.at(node)) {
        for (const double angle : of_triangle[static_cast<std::size_t>(t)]) {
          if (angle > 0) around.push_back(angle);
        }
      }
    }
    cosines.push_back(std::cos(std::min(sharp, kTimesMedian * std::max(everywhere, middle_of(around)))));
  }
  return cosines;
}

Eigen::RowVector3d SmoothFacets::rise(Eigen::Index triangle, const Eigen::RowVector3d& point) const {
  const Eigen::RowVector3d normal = normals_.row(triangle);
  if (normal.isZero(0)) return normal;
  const Eigen::Vector3d a = corner(triangle, 0), b = corner(triangle, 1), c = corner(triangle, 2),
                        at = point.transpose();
  const double whole = (b - a).cross(c - a).norm();
  const auto part = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    return std::clamp((p - at).cross(q - at).dot(normal.transpose()) / whole, 0.0, 1.0);
  };
  const double u = part(b, c), v = part(c, a), w = part(a, b);
  const Eigen::Vector3d& bulge = bulges_[static_cast<std::size_t>(triangle)];
  return (v * w * bulge[0] + w * u * bulge[1] + u * v * bulge[2]) * normal;
}

}  // namespace ringdown::mesh
