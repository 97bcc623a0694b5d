// The nearest point of a triangle against an oracle that tries a grid of the triangle's points, one after the other.
#include "engine/base/triangle.h"

#include "engine/base/vec3.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace ringdown {
namespace {

using Triangle = std::array<Vec3, 3>;

constexpr int kGrid = 48;

double nearest_on_grid(Vec3 p, const Triangle& triangle) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kGrid; ++i) {
    for (int j = 0; i + j <= kGrid; ++j) {
      const double u = double(i) / kGrid, v = double(j) / kGrid;
      best = std::min(best, length(u * triangle[0] + v * triangle[1] + (1 - u - v) * triangle[2] - p));
    }
  }
  return best;
}

void expect_nearest(Vec3 p, const Triangle& triangle) {
  const std::array<double, 3> weights = nearest_on_triangle(p, triangle);
  for (const double weight : weights) ASSERT_GE(weight, 0);
  ASSERT_NEAR(weights[0] + weights[1] + weights[2], 1, 1e-12);
  const double found = length(at_weights(triangle, weights) - p), tried = nearest_on_grid(p, triangle);
  ASSERT_LE(found, tried + 1e-9);
  // The true nearest point is at most a step of the grid from one of its points.
  const double side = std::max(
      {length(triangle[1] - triangle[0]), length(triangle[2] - triangle[0]), length(triangle[2] - triangle[1])});
  ASSERT_GE(found, tried - side / kGrid);
}

class TrianglePoints : public ::testing::Test {
 protected:
  Vec3 any_point(double size) { return size * Vec3{unit_(random_), unit_(random_), unit_(random_)}; }
  // Few values a coordinate, so that edges, corners and right angles are met exactly.
  Vec3 coarse_point() {
    return 0.1 * Vec3{std::round(3 * unit_(random_)), std::round(3 * unit_(random_)), std::round(3 * unit_(random_))};
  }

 private:
  std::mt19937 random_{20};
  std::uniform_real_distribution<double> unit_{-1, 1};
};

TEST_F(TrianglePoints, NoPointOfTheTriangleIsNearer) {
  for (int i = 0; i < 3000; ++i)
    ASSERT_NO_FATAL_FAILURE(expect_nearest(any_point(2), {any_point(1), any_point(1), any_point(1)})) << i;
}

TEST_F(TrianglePoints, NorInTrianglesOfRightAnglesWithoutAreaOrOfOnePoint) {
  for (int i = 0; i < 3000; ++i)
    ASSERT_NO_FATAL_FAILURE(expect_nearest(coarse_point(), {coarse_point(), coarse_point(), coarse_point()})) << i;
}

TEST_F(TrianglePoints, OnALineWithoutAreaTheWeightsAddUpToOne) {
  ASSERT_NO_FATAL_FAILURE(
      expect_nearest({0, -0.1, 0.2}, {Vec3{-0.1, 0.2, 0.1}, Vec3{0.1, 0, -0.1}, Vec3{0.2, -0.1, -0.2}}));
}

TEST_F(TrianglePoints, PointsOfTheTriangleFindThemselves) {
  for (int i = 0; i < 1000; ++i) {
    const Triangle triangle = {any_point(1), any_point(1), any_point(1)};
    const double u = (i % 10) / 10.0, v = (1 - u) * (i / 10 % 10) / 10.0;
    const Vec3 p = at_weights(triangle, {u, v, 1 - u - v});
    ASSERT_LT(length(at_weights(triangle, nearest_on_triangle(p, triangle)) - p), 1e-9) << i;
  }
}

}  // namespace
}  // namespace ringdown
