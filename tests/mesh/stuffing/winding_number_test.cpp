#include "engine/mesh/stuffing/winding_number.h"

#include "tests/mesh/stuffing/sample_surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown {
namespace {

using namespace test;

std::vector<Vector3> points(int count, double reach, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-reach, reach);
  std::vector<Vector3> all;
  for (int n = 0; n < count; ++n) all.emplace_back(any(random), any(random), any(random));
  return all;
}

// The excess of the spherical triangle's angles over pi.
double by_angles(const Soup& soup, const Vector3& point) {
  double sum = 0;
  for (int t = 0; t < soup.triangles.rows(); ++t) {
    Vector3 u[3];
    for (int k = 0; k < 3; ++k) u[k] = (soup.nodes.row(soup.triangles(t, k)).transpose() - point).normalized();
    if (u[0].cross(u[1]).norm() < 1e-9 || u[1].cross(u[2]).norm() < 1e-9 || u[2].cross(u[0]).norm() < 1e-9) continue;
    double excess = -std::numbers::pi;
    for (int k = 0; k < 3; ++k) {
      const Vector3 a = u[k], b = u[(k + 1) % 3], c = u[(k + 2) % 3];
      excess += std::atan2(a.cross(b).cross(a.cross(c)).norm(), a.cross(b).dot(a.cross(c)));
    }
    sum += (u[0].dot(u[1].cross(u[2])) > 0 ? 1 : -1) * excess;
  }
  return sum / (4 * std::numbers::pi);
}

// A tube open at both ends, of triangles forty times as long as wide.
Soup needles() {
  return turned_surface(96, 1, [](double s) { return Eigen::Vector2d(0.5, 2.6 * s - 1.3); });
}

TEST(WindingNumber, TheWindingNumberIsTheSumOfTheSphericalTrianglesWithinItsTolerance) {
  for (const Soup& soup :
       {with_holes(sphere_surface(1, 40), 0.1), random_soup(600, 0.3, 1), bowl_surface(1, 0.1, 30), needles()}) {
    const mesh::WindingNumber winding(soup);
    const double sign = winding.turned() ? -1 : 1;
    for (const Vector3& point : points(60, 1.5, 2)) {
      const double truth = sign * by_angles(soup, point);
      EXPECT_NEAR(winding.at(point, 0), truth, 1e-7);
      for (const double tolerance : {0.1, 1e-2, 1e-3, 1e-5})
        EXPECT_NEAR(winding.at(point, tolerance), truth, tolerance + 1e-7);
    }
  }
}

TEST(WindingNumber, TheWindingNumberIsOneInsideAndNoneOutside) {
  const Soup sphere = sphere_surface(1);
  const mesh::WindingNumber winding(sphere);
  for (const Vector3& point : points(500, 1.3, 3)) {
    if (std::abs(point.norm() - 1) < 0.01) continue;
    EXPECT_NEAR(winding.at(point, 1e-9), point.norm() < 1, 1e-9);
    EXPECT_EQ(winding.inside(point), point.norm() < 1);
  }
}

TEST(WindingNumber, TheWindingNumberOfADiskIsThatOfItsCone) {
  const Soup disk = turned_surface(400, 1, [](double t) { return Eigen::Vector2d(1 - t, 0); });
  const mesh::WindingNumber winding(disk);
  for (const double height : {0.1, 0.5, 2.}) {  // a disk seen from its axis fills a cap of the sphere
    const double cap = (1 - height / std::hypot(1, height)) / 2;
    EXPECT_NEAR(std::abs(winding.at({0, 0, height}, 0)), cap, 1e-4);
  }
}

TEST(WindingNumber, TheWindingNumberOfASurfaceInsideOutIsTurned) {
  const Soup box = moved(box_surface({1, 2, 3}), {50, 60, 70});
  EXPECT_FALSE(mesh::WindingNumber(box).turned());
  const mesh::WindingNumber winding(inside_out(box));
  EXPECT_TRUE(winding.turned());
  EXPECT_TRUE(winding.inside({50.5, 61, 71}));
}

// The volume between a thin wall and a point is more than that of the wall, so that its sign tells nothing of a box
// whose upper face is missing on the outside.
TEST(WindingNumber, AnOpenThinShellIsTurnedOnlyWhereItIsInsideOut) {
  const Soup outer = moved(box_surface({1, 1, 1}), {-0.5, -0.5, -0.5}),
             inner = inside_out(moved(box_surface({0.98, 0.98, 0.98}), {-0.49, -0.49, -0.49}));
  Soup shell{Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>(outer.nodes.rows() + inner.nodes.rows(), 3), {}};
  shell.nodes << outer.nodes, inner.nodes;
  std::vector<Eigen::RowVector3i> kept;
  for (int t = 0; t < outer.triangles.rows(); ++t) {
    const Eigen::RowVector3i row = outer.triangles.row(t);
    const bool top = outer.nodes(row[0], 2) > 0 && outer.nodes(row[1], 2) > 0 && outer.nodes(row[2], 2) > 0;
    if (!top) kept.push_back(row);
  }
  for (int t = 0; t < inner.triangles.rows(); ++t)
    kept.emplace_back(inner.triangles.row(t).array() + static_cast<int>(outer.nodes.rows()));
  shell.triangles.resize(static_cast<Eigen::Index>(kept.size()), 3);
  for (std::size_t t = 0; t < kept.size(); ++t) shell.triangles.row(static_cast<Eigen::Index>(t)) = kept[t];
  EXPECT_FALSE(mesh::WindingNumber(shell).turned());
  EXPECT_TRUE(mesh::WindingNumber(shell).inside({0.2, 0.1, -0.495}));
  EXPECT_TRUE(mesh::WindingNumber(inside_out(shell)).turned());
}

TEST(WindingNumber, AWayThroughASphereCrossesItTwice) {
  const mesh::WindingNumber winding(sphere_surface(1));
  for (const Vector3& aim : points(200, 0.4, 5)) {
    const Vector3 from(3, 0.1, 0.2), to = from + 2 * (aim - from);
    const std::vector<double> found = winding.crossings(from, to);
    ASSERT_EQ(found.size(), 2u);
    for (const double at : found) EXPECT_NEAR((from + at * (to - from)).norm(), 1, 2e-3);
  }
}

TEST(WindingNumber, TheWindingNumberOfNothingIsNone) {
  const mesh::WindingNumber winding(Soup{});
  EXPECT_EQ(winding.at({0, 0, 0}), 0);
  EXPECT_FALSE(winding.inside({0, 0, 0}));
  EXPECT_TRUE(winding.crossings({0, 0, 0}, {1, 0, 0}).empty());
}

}  // namespace
}  // namespace ringdown
