#include "engine/mesh/smooth_facets.h"

#include "engine/mesh/remesh.h"

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
// The normal at a corner is the mean over the corner's triangles that do not belong to another side of a sharp edge,
// weighted by their angles there. Triangles that are much smaller than the facet count for less: a large flat face next
// to a narrow rounded edge is flat, though its corners lie on the rounding. The area's ratio is squared, so that the
// rise of such a face does not exceed that of the rounding.
namespace ringdown::mesh {
namespace {

constexpr double kMaxFan = 500;       // triangles at a node; where there are more, the facets there count as flat
constexpr double kSimilarSize = 0.5;  // an area's ratio from which on a neighbour counts in full

Eigen::Vector3d corner(const TriangleMesh& mesh, Eigen::Index t, int i) {
  return mesh.nodes.row(mesh.triangles(t, i)).transpose();
}

double angle_at(const TriangleMesh& mesh, Eigen::Index t, int i) {
  const Eigen::Vector3d a = corner(mesh, t, (i + 1) % 3) - corner(mesh, t, i),
                        b = corner(mesh, t, (i + 2) % 3) - corner(mesh, t, i);
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// The triangles at each node: those of node n are triangles[first[n]] up to triangles[first[n + 1]].
struct Fans {
  std::vector<std::size_t> first;
  std::vector<std::int32_t> triangles;

  explicit Fans(const TriangleMesh& mesh) : first(static_cast<std::size_t>(mesh.nodes.rows()) + 1, 0) {
    for (const std::int32_t n : mesh.triangles.reshaped()) ++first[static_cast<std::size_t>(n) + 1];
    for (std::size_t n = 1; n < first.size(); ++n) first[n] += first[n - 1];
    triangles.resize(first.back());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::int32_t t = 0; t < mesh.triangles.rows(); ++t) {
      for (int i = 0; i < 3; ++i) triangles[next[static_cast<std::size_t>(mesh.triangles(t, i))]++] = t;
    }
  }
};

}  // namespace

SmoothFacets::SmoothFacets(const TriangleMesh& surface)
    : surface_(surface), normals_(surface.triangles.rows(), 3), bulges_(surface.triangles.rows()) {
  const double smooth = std::cos(kSharpAngle_deg * std::numbers::pi / 180);
  std::vector<double> areas;
  std::vector<std::array<double, 3>> angles;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const Eigen::Vector3d twice =
        (corner(surface, t, 1) - corner(surface, t, 0)).cross(corner(surface, t, 2) - corner(surface, t, 0));
    areas.push_back(0.5 * twice.norm());
    normals_.row(t) = is_degenerate(surface, t) ? Eigen::Vector3d(0, 0, 0) : twice.normalized();
    angles.push_back({angle_at(surface, t, 0), angle_at(surface, t, 1), angle_at(surface, t, 2)});
  }
  const Fans fans(surface);
  const auto normal_at = [&](Eigen::Index t, int i) {
    const std::int32_t node = surface.triangles(t, i);
    const std::size_t from = fans.first[static_cast<std::size_t>(node)],
                      to = fans.first[static_cast<std::size_t>(node) + 1];
    Eigen::RowVector3d sum = normals_.row(t) * 1e-12;
    if (static_cast<double>(to - from) > kMaxFan) return Eigen::RowVector3d(normals_.row(t));
    for (std::size_t k = from; k < to; ++k) {
      const std::int32_t other = fans.triangles[k];
      if (normals_.row(other).dot(normals_.row(t)) < smooth) continue;
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
      bulge[i] = 0.5 * (at[b] - at[a]).dot((corner(surface, t, b) - corner(surface, t, a)).transpose());
    }
  }
}

Eigen::RowVector3d SmoothFacets::rise(Eigen::Index triangle, const Eigen::RowVector3d& point) const {
  const Eigen::RowVector3d normal = normals_.row(triangle);
  if (normal.isZero(0)) return normal;
  const Eigen::Vector3d a = corner(surface_, triangle, 0), b = corner(surface_, triangle, 1),
                        c = corner(surface_, triangle, 2), at = point.transpose();
  const double whole = (b - a).cross(c - a).norm();
  const auto part = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    return std::clamp((p - at).cross(q - at).dot(normal.transpose()) / whole, 0.0, 1.0);
  };
  const double u = part(b, c), v = part(c, a), w = part(a, b);
  const Eigen::Vector3d& bulge = bulges_[static_cast<std::size_t>(triangle)];
  return (v * w * bulge[0] + w * u * bulge[1] + u * v * bulge[2]) * normal;
}

}  // namespace ringdown::mesh
