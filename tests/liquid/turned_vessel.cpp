#include "tests/liquid/turned_vessel.h"

#include <array>
#include <cmath>
#include <numbers>

namespace ringdown {

mesh::TriangleMesh turned(const std::vector<std::pair<double, double>>& line, double side, int around) {
  std::vector<std::pair<double, double>> fine;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const auto [r, z] = line[i];
    fine.push_back(line[i]);
    if (i + 1 == line.size()) break;
    const auto [nr, nz] = line[i + 1];
    const int parts = std::max(1, static_cast<int>(std::lround(std::hypot(nr - r, nz - z) / side)));
    for (int k = 1; k < parts; ++k) fine.emplace_back(r + (nr - r) * k / parts, z + (nz - z) * k / parts);
  }
  std::vector<std::array<double, 3>> nodes;
  std::vector<std::vector<int>> rings;
  for (const auto& [r, z] : fine) {
    std::vector<int>& ring = rings.emplace_back();
    if (r == 0) {
      ring.assign(static_cast<std::size_t>(around), static_cast<int>(nodes.size()));
      nodes.push_back({0, 0, z});
      continue;
    }
    for (int a = 0; a < around; ++a) {
      const double angle = 2 * std::numbers::pi * a / around;
      ring.push_back(static_cast<int>(nodes.size()));
      nodes.push_back({r * std::cos(angle), r * std::sin(angle), z});
    }
  }
  std::vector<std::array<int, 3>> triangles;
  const auto add = [&](int a, int b, int c) {
    if (a != b && b != c && c != a) triangles.push_back({a, b, c});
  };
  for (std::size_t i = 0; i + 1 < rings.size(); ++i) {
    for (int a = 0; a < around; ++a) {
      const auto here = static_cast<std::size_t>(a), next = static_cast<std::size_t>((a + 1) % around);
      add(rings[i][here], rings[i][next], rings[i + 1][next]);
      add(rings[i][here], rings[i + 1][next], rings[i + 1][here]);
    }
  }
  mesh::TriangleMesh surface;
  surface.nodes.resize(static_cast<Eigen::Index>(nodes.size()), 3);
  surface.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t n = 0; n < nodes.size(); ++n)
    surface.nodes.row(static_cast<Eigen::Index>(n)) << nodes[n][0], nodes[n][1], nodes[n][2];
  for (std::size_t t = 0; t < triangles.size(); ++t)
    surface.triangles.row(static_cast<Eigen::Index>(t)) << triangles[t][0], triangles[t][1], triangles[t][2];
  return surface;
}

mesh::TriangleMesh together(const std::vector<mesh::TriangleMesh>& surfaces) {
  mesh::TriangleMesh all;
  for (const mesh::TriangleMesh& one : surfaces) {
    const Eigen::Index nodes = all.nodes.rows(), triangles = all.triangles.rows();
    all.nodes.conservativeResize(nodes + one.nodes.rows(), 3);
    all.nodes.bottomRows(one.nodes.rows()) = one.nodes;
    all.triangles.conservativeResize(triangles + one.triangles.rows(), 3);
    all.triangles.bottomRows(one.triangles.rows()) = one.triangles.array() + static_cast<std::int32_t>(nodes);
  }
  return all;
}

}  // namespace ringdown
