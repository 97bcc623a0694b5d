#include "engine/mesh/surface/simplify.h"

#include "tests/mesh/sample_surfaces.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown {
namespace {

double enclosed(const mesh::TriangleMesh& surface) {
  double sum = 0;
  for (const auto& row : surface.triangles.rowwise()) {
    const Eigen::RowVector3d a = surface.nodes.row(row[0]), b = surface.nodes.row(row[1]),
                             c = surface.nodes.row(row[2]);
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

// Each edge is run along as often one way as the other.
bool closed(const mesh::TriangleMesh& surface) {
  const auto count = static_cast<std::size_t>(surface.triangles.rows());
  const auto edges = mesh::edges_of(surface, std::vector<bool>(count, true));
  for (std::size_t first = 0, last; first < edges.size(); first = last) {
    last = mesh::end_of_edge(edges, first);
    const auto forward = std::count_if(edges.begin() + static_cast<std::ptrdiff_t>(first),
                                       edges.begin() + static_cast<std::ptrdiff_t>(last),
                                       [](const mesh::EdgeUse& use) { return use.forward; });
    if (2 * static_cast<std::size_t>(forward) != last - first) return false;
  }
  return true;
}

TEST(Simplify, AFineBallKeepsItsVolumeAndStaysClosed) {
  constexpr double kBall = 0.05;
  const mesh::TriangleMesh ball = test::moved(test::sphere(kBall, 300), {1, 2, 3});
  const mesh::TriangleMesh fewer = mesh::simplified(ball, 5000, 0.005 * kBall);
  EXPECT_LE(fewer.triangles.rows(), 5000);
  EXPECT_GE(fewer.triangles.rows(), 4900);
  EXPECT_TRUE(closed(fewer));
  for (const auto& at : fewer.nodes.rowwise()) {
    EXPECT_NEAR((at - Eigen::RowVector3d(1, 2, 3)).norm(), kBall, 1e-12) << "nodes keep their places";
  }
  EXPECT_NEAR(enclosed(fewer) / (4 * std::numbers::pi / 3 * std::pow(kBall, 3)), 1, 5e-3);
}

// A box loses triangles and nothing of its volume; a ball keeps what it takes to follow it, however few are wanted.
TEST(Simplify, NothingMovesFartherThanAllowed) {
  mesh::TriangleMesh box = test::box({0, 0, 0}, {0.1, 0.08, 0.06});
  for (int times = 0; times < 5; ++times) box = test::subdivided(box);
  const mesh::TriangleMesh corners = mesh::simplified(box, 12, 1e-5);
  EXPECT_NEAR(enclosed(corners), 0.1 * 0.08 * 0.06, 1e-9);
  EXPECT_LT(4 * corners.triangles.rows(), box.triangles.rows());
  const mesh::TriangleMesh ball = test::sphere(0.05, 100);
  EXPECT_GT(enclosed(mesh::simplified(ball, 12, 1e-4)), 0.98 * enclosed(ball));
}

TEST(Simplify, WhatIsFewEnoughStaysAsItIs) {
  const mesh::TriangleMesh cup = test::cup(0.04, 0.09, 0.004, 24);
  const mesh::TriangleMesh same = mesh::simplified(cup, static_cast<std::size_t>(cup.triangles.rows()), 1);
  EXPECT_EQ(same.nodes, cup.nodes);
  EXPECT_EQ(same.triangles, cup.triangles);
}

}  // namespace
}  // namespace ringdown
