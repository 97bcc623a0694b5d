#include "tests/bake/bank_surface.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace ringdown::test {
namespace {

using Eigen::Vector3d;

double angle_deg(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
}

double min_angle(const std::array<Vector3d, 3>& corner) {
  double min = 180;
  for (int k = 0; k < 3; ++k) {
    const Vector3d& at = corner[k];
    min = std::min(min, angle_deg(corner[(k + 1) % 3] - at, corner[(k + 2) % 3] - at));
  }
  return min;
}

}  // namespace

BankSurface look_at_surface(const modal::Bank& bank) {
  constexpr double kFlatDeg = 0.01, kNeedleDeg = 20, kSmoothDeg = 15;
  BankSurface found;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::size_t>> edges;  // from, to: triangles
  std::vector<Vector3d> normals;
  std::vector<double> angles;
  double volume = 0;
  for (std::size_t t = 0; t < bank.triangles.size(); ++t) {
    std::array<Vector3d, 3> corner;
    for (int k = 0; k < 3; ++k) {
      const modal::Vec3f& at = bank.positions[bank.triangles[t][k]];
      corner[k] = Vector3d(at[0], at[1], at[2]);
      edges[{bank.triangles[t][k], bank.triangles[t][(k + 1) % 3]}].push_back(t);
    }
    normals.push_back((corner[1] - corner[0]).cross(corner[2] - corner[0]));
    angles.push_back(min_angle(corner));
    volume += corner[0].dot(corner[1].cross(corner[2])) / 6;
    if (angles.back() < kFlatDeg) ++found.flat;
  }
  std::vector<bool> smooth(bank.triangles.size(), true);
  for (const auto& [edge, sides] : edges) {
    const auto other = edges.find({edge.second, edge.first});
    if (sides.size() != 1 || other == edges.end() || other->second.size() != 1) {
      ++found.open_edges;
    } else if (angle_deg(normals[sides[0]], normals[other->second[0]]) >= kSmoothDeg) {
      smooth[sides[0]] = false;
    }
  }
  for (std::size_t t = 0; t < angles.size(); ++t) {
    if (!smooth[t]) continue;
    found.min_angle_deg = std::min(found.min_angle_deg, angles[t]);
    if (angles[t] < kNeedleDeg) ++found.needles;
  }
  found.volume_error = volume / (bank.mass->mass_kg / bank.material->density_kg_m3) - 1;
  return found;
}

}  // namespace ringdown::test
