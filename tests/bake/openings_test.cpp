// Openings between curved walls, in flat triangles.
#include "engine/bake/cavity/openings.h"
#include "tests/fem/sample_meshes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>
#include <vector>

namespace ringdown::openings_test {
namespace {

constexpr double kRadius = 0.8, kDegree = std::numbers::pi / 180;

// A wall around the z axis, through 300 degrees and 1 high, of six elements of order 2: the flat triangles of its
// inside are chords of 25 degrees.
mesh::TetMesh curved_wall() {
  mesh::TetMesh wall = mesh::to_order(test::box_mesh({6, 1, 6}, {300 * kDegree, 0.2, 1}), 2);
  for (auto node : wall.nodes.rowwise()) {
    const double angle = node[0], radius = kRadius + node[1];
    node[0] = radius * std::sin(angle);
    node[1] = radius * std::cos(angle);
  }
  return wall;
}

mesh::TriangleMesh flat(const mesh::TetMesh& mesh, const mesh::Boundary& skin) {
  mesh::TriangleMesh surface;
  surface.nodes.resize(static_cast<Eigen::Index>(skin.nodes.size()), 3);
  for (std::size_t n = 0; n < skin.nodes.size(); ++n)
    surface.nodes.row(static_cast<Eigen::Index>(n)) = mesh.nodes.row(skin.nodes[n]);
  surface.triangles.resize(static_cast<Eigen::Index>(skin.triangles.size()), 3);
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i)
      surface.triangles(static_cast<Eigen::Index>(t), i) = static_cast<std::int32_t>(skin.triangles[t][i]);
  }
  return surface;
}

// Triangles of the inside, away from its edges, from a height of `low` to 5/6 and from 50 to 250 degrees.
std::vector<Eigen::Index> inside(const mesh::TriangleMesh& surface, double low) {
  std::vector<Eigen::Index> chosen;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    bool all = true;
    for (const int n : surface.triangles.row(t)) {
      const Eigen::Vector3d at = surface.nodes.row(n).transpose();
      const double angle = std::atan2(-at.x(), -at.y()) / kDegree + 180;
      all = all && at.head(2).norm() < kRadius + 1e-9 && angle > 49.9 && angle < 250.1 && at.z() > low - 1e-9 &&
            at.z() < 5.0 / 6 + 1e-9;
    }
    if (all) chosen.push_back(t);
  }
  return chosen;
}

// The area between the axis and the triangles, over that of the round sector. By Gauss: half the integral of (x, y).n,
// because the sector's other faces are parallel to (x, y).
double opening(const mesh::TriangleMesh& surface, const std::vector<Eigen::Index>& triangles, double low) {
  double volume = 0;
  for (const Eigen::Index t : triangles) {
    const auto corner = [&](int i) -> Eigen::Vector3d {
      return surface.nodes.row(surface.triangles(t, i)).transpose();
    };
    const Eigen::Vector3d twice = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    volume -= ((corner(0) + corner(1) + corner(2)) / 3).head(2).dot(twice.head(2)) / 4;
  }
  return volume / (kRadius * kRadius / 2 * 200 * kDegree * (5.0 / 6 - low));
}

TEST(Openings, AreAsWideAsTheCurvedWalls) {
  constexpr double kLow = 1.0 / 6;
  const mesh::TetMesh wall = curved_wall();
  const mesh::Boundary skin = mesh::boundary_of(wall);
  mesh::TriangleMesh surface = flat(wall, skin);
  const std::vector<Eigen::Index> triangles = inside(surface, kLow);
  EXPECT_NEAR(opening(surface, triangles, kLow), std::sin(25 * kDegree) / (25 * kDegree), 1e-3);  // 3 % too narrow
  const mesh::TriangleMesh before = surface;
  bake::keep_openings(wall, skin, surface);
  EXPECT_NEAR(opening(surface, triangles, kLow), 1, 3e-3);
  for (Eigen::Index n = 0; n < surface.nodes.rows(); ++n) {
    const bool on_end = before.nodes(n, 2) == 0 || before.nodes(n, 2) == 1;  // on a plane face or its edge
    EXPECT_TRUE(!on_end || (surface.nodes.row(n) - before.nodes.row(n)).norm() < 1e-12) << n;
  }
}

TEST(Openings, AreKeptAboveALiquidWhoseLevelStays) {
  constexpr double kLow = 0.5, kLevel = 0.48;
  const mesh::TetMesh wall = curved_wall();
  const mesh::Boundary skin = mesh::boundary_of(wall);
  mesh::TriangleMesh surface = flat(wall, skin);
  std::vector<Eigen::Index> dry;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    bool above = true;
    for (const int n : surface.triangles.row(t)) above = above && surface.nodes(n, 2) > 0.4;
    if (above) dry.push_back(t);
  }
  surface.triangles = mesh::Triangles(surface.triangles(dry, Eigen::all));
  for (Eigen::Index n = 0; n < surface.nodes.rows(); ++n) {
    if (std::abs(surface.nodes(n, 2) - 5.0 / 12) < 1e-9) surface.nodes(n, 2) = kLevel;  // the lowest nodes above 0.4
  }
  mesh::drop_unused_nodes(surface);
  const std::vector<Eigen::Index> triangles = inside(surface, kLow);
  const mesh::TriangleMesh before = surface;
  bake::keep_openings(wall, skin, surface);
  EXPECT_NEAR(opening(surface, triangles, kLow), 1, 3e-3);
  int on_level = 0;
  for (Eigen::Index n = 0; n < surface.nodes.rows(); ++n) {
    if (before.nodes(n, 2) != kLevel) continue;
    EXPECT_EQ(surface.nodes.row(n), before.nodes.row(n));
    ++on_level;
  }
  EXPECT_GT(on_level, 20);
}

}  // namespace
}  // namespace ringdown::openings_test
