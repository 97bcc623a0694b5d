#include "engine/scene/hull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace ringdown::scene::hull_test {
namespace {

std::vector<Vec3> points_on_sphere(std::size_t count, double radius) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  while (points.size() < count) {
    const Vec3 p{normal(random), normal(random), normal(random)};
    points.push_back((radius / length(p)) * p);
  }
  return points;
}

// Divergence theorem; positive when the triangles face outwards.
double volume(const Hull& hull) {
  double six = 0;
  for (const auto& [a, b, c] : hull.triangles) six += dot(hull.points[a], cross(hull.points[b], hull.points[c]));
  return six / 6;
}

TEST(Hull, TheHullOfACubeWithPointsInsideIsTheCube) {
  std::vector<Vec3> points;
  for (int k = 0; k < 8; ++k) points.push_back({k & 1 ? 1.0 : 0.0, k & 2 ? 1.0 : 0.0, k & 4 ? 1.0 : 0.0});
  for (int k = 1; k < 10; ++k) points.push_back({0.1 * k, 0.5, 0.3});
  const auto hull = convex_hull(points);
  ASSERT_TRUE(hull) << hull.error().message;
  EXPECT_EQ(hull->points.size(), 8u);
  EXPECT_EQ(hull->triangles.size(), 12u);
  EXPECT_NEAR(volume(*hull), 1, 1e-12);
}

TEST(Hull, TheHullOfManyPointsIsSmallLiesOnThemAndHoldsNearlyAllTheirVolume) {
  const auto points = points_on_sphere(5000, 0.1);
  const auto hull = convex_hull(points);
  ASSERT_TRUE(hull) << hull.error().message;
  EXPECT_LE(hull->points.size(), kMaxHullPoints);
  for (const Vec3& p : hull->points) EXPECT_NE(std::ranges::find(points, p), points.end());
  EXPECT_EQ(hull->triangles.size(), 2 * hull->points.size() - 4) << "Euler's formula for a closed surface";
  EXPECT_GT(volume(*hull), 0.93 * 4 / 3 * M_PI * 1e-3);
}

TEST(Hull, AHullOfFlatOrTooFewPointsIsRefused) {
  std::vector<Vec3> flat;
  for (int k = 0; k < 50; ++k) flat.push_back({std::cos(k), std::sin(k), 0});
  const auto hull = convex_hull(flat);
  ASSERT_FALSE(hull);
  EXPECT_NE(hull.error().message.find("lie in one plane"), std::string::npos);
  EXPECT_FALSE(convex_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

}  // namespace
}  // namespace ringdown::scene::hull_test
