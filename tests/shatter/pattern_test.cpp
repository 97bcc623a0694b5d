// Seeds lie in the wall, keep apart, nest, and are as uneven as real fragments.
#include "engine/shatter/pattern.h"
#include "tests/shatter/bodies.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <vector>

namespace ringdown::test {
namespace {

using shatter::make_seeds;
using shatter::Pattern;
using shatter::PatternOptions;
using shatter::Seeds;

constexpr std::array kPatterns = {Pattern::kUniform, Pattern::kImpact, Pattern::kRadial};

bool lies_in(const mesh::TetMesh& body, const Eigen::RowVector3d& point) {
  for (Eigen::Index e = 0; e < body.elements.rows(); ++e) {
    const mesh::Corners corners = corners_of(body, e);
    const Eigen::RowVector3d shares = (point - corners.row(0)) * mesh::jacobian(corners).inverse();
    if (shares.minCoeff() > -1e-9 && shares.sum() < 1 + 1e-9) return true;
  }
  return false;
}

double least_distance(const mesh::Points& points) {
  double min = std::numeric_limits<double>::max();
  for (Eigen::Index a = 0; a < points.rows(); ++a) {
    for (Eigen::Index b = 0; b < a; ++b) min = std::min(min, (points.row(a) - points.row(b)).norm());
  }
  return min;
}

TEST(ShatterPattern, SeedsLieInTheWallAndKeepApart) {
  for (const Body& body : {Body{"plate", plate(10)}, {"tube", tube(2, 16, 6)}, {"bowl", bowl(3, 6)}}) {
    const Eigen::RowVector3d at = body.mesh.nodes.row(7);
    for (const Pattern pattern : kPatterns) {
      const auto seeds =
          make_seeds(body.mesh, {.pattern = pattern, .pieces = {20}, .impact_m = {at[0], at[1], at[2]}}).value();
      ASSERT_EQ(seeds.points.rows(), 20);
      for (const auto& seed : seeds.points.rowwise()) EXPECT_TRUE(lies_in(body.mesh, seed)) << body.name;
      EXPECT_GT(least_distance(seeds.points), 0.0025) << body.name << ", walls of 2 to 4.5 mm";
    }
  }
}

TEST(ShatterPattern, ADistanceThatCannotBeKeptShrinks) {
  const auto seeds = make_seeds(plate(4), {.pieces = {30}, .min_distance_m = 0.5}).value();
  EXPECT_EQ(seeds.points.rows(), 30);
  EXPECT_GT(least_distance(seeds.points), 0.005);
}

TEST(ShatterPattern, TheSameSeedGivesTheSamePattern) {
  const mesh::TetMesh body = plate(10);
  for (const Pattern pattern : kPatterns) {
    const PatternOptions options{.pattern = pattern, .pieces = {3, 30}, .impact_m = {0.1, 0.1, 0}};
    PatternOptions other = options;
    other.seed = 2;
    const Seeds first = make_seeds(body, options).value(), second = make_seeds(body, options).value();
    EXPECT_EQ(first.points, second.points);
    EXPECT_EQ(first.group_of_cell, second.group_of_cell);
    EXPECT_NE(first.points, make_seeds(body, other).value().points);
  }
}

TEST(ShatterPattern, CoarseGroupsAreUnionsOfFineOnes) {
  for (const Pattern pattern : kPatterns) {
    const auto seeds = make_seeds(plate(10), {.pattern = pattern, .pieces = {4, 14, 48}, .impact_m = {0.1, 0.1, 0}});
    const auto& groups = seeds->group_of_cell;
    ASSERT_EQ(groups.size(), 3u);
    EXPECT_EQ(std::set(groups[0].begin(), groups[0].end()).size(), 4u);
    EXPECT_EQ(std::set(groups[1].begin(), groups[1].end()).size(), 14u);
    EXPECT_EQ(std::set(groups[2].begin(), groups[2].end()).size(), 48u);
    for (std::size_t a = 0; a < 48; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        if (groups[1][a] == groups[1][b]) {
          EXPECT_EQ(groups[0][a], groups[0][b]);
        }
      }
    }
  }
}

// The coefficient of variation of the cells' areas, by counting points of a grid.
double mean_variation(const mesh::TetMesh& body, Pattern pattern) {
  constexpr int kGrid = 150, kSeeds = 60, kRuns = 10;
  double sum = 0;
  for (int run = 1; run <= kRuns; ++run) {
    const auto seeds = make_seeds(body, {.pattern = pattern,
                                         .pieces = {kSeeds},
                                         .impact_m = {0.16, 0.14, 0.0045},
                                         .seed = static_cast<std::uint64_t>(run)});
    std::vector<double> areas(kSeeds, 0);
    for (int i = 0; i < kGrid * kGrid; ++i) {
      const Eigen::RowVector3d at(0.26 * (i % kGrid + 0.5) / kGrid, 0.26 * (i / kGrid + 0.5) / kGrid, 0.00225);
      Eigen::Index nearest = 0;
      (seeds->points.rowwise() - at).rowwise().squaredNorm().minCoeff(&nearest);
      ++areas[static_cast<std::size_t>(nearest)];
    }
    const double mean = static_cast<double>(kGrid * kGrid) / kSeeds;
    double square = 0;
    for (const double area : areas) square += (area - mean) * (area - mean) / kSeeds;
    sum += std::sqrt(square) / mean;
  }
  return sum / kRuns;
}

// Ten patterns on a square of 26 cm. Uniform seeds vary by 0.53 when they may be arbitrarily near, as is known of
// Poisson-Voronoi cells; fragments of plates vary about twice as much.
TEST(ShatterPattern, ImpactPatternsAreAsUnevenAsFragments) {
  const mesh::TetMesh body = plate(20);
  const double uniform = mean_variation(body, Pattern::kUniform), impact = mean_variation(body, Pattern::kImpact),
               radial = mean_variation(body, Pattern::kRadial);
  RecordProperty("uniform", std::to_string(uniform));
  RecordProperty("impact", std::to_string(impact));
  RecordProperty("radial", std::to_string(radial));
  EXPECT_GT(uniform, 0.4);
  EXPECT_LT(uniform, 0.65);
  EXPECT_GT(impact, 0.8);
  EXPECT_LT(impact, 1.25);
  EXPECT_GT(radial, 0.8);
  EXPECT_LT(radial, 1.8);
}

TEST(ShatterPattern, RaysSurroundTheImpact) {
  const Eigen::RowVector3d impact(0.13, 0.13, 0.0045);
  const auto seeds =
      make_seeds(plate(20), {.pattern = Pattern::kRadial, .pieces = {60}, .impact_m = {0.13, 0.13, 0.0045}});
  std::array<int, 8> sectors{};
  std::vector<double> radii;
  for (const auto& seed : seeds->points.rowwise()) {
    const Eigen::RowVector3d arm = seed - impact;
    ++sectors[static_cast<std::size_t>(std::floor(4 + 3.999 * std::atan2(arm[1], arm[0]) / std::numbers::pi))];
    radii.push_back(arm.norm());
  }
  for (const int count : sectors) EXPECT_GE(count, 3);
  std::sort(radii.begin(), radii.end());
  EXPECT_LT(radii[20], 0.06) << "a third of the seeds lie near the impact";
}

TEST(ShatterPattern, WrongOptionsAreRefusedInASentence) {
  const mesh::TetMesh body = plate(4);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const PatternOptions& options : {PatternOptions{.pieces = {}},
                                        {.pieces = {0}},
                                        {.pieces = {5, 5}},
                                        {.pieces = {9, 3}},
                                        {.pieces = {5000}},
                                        {.impact_m = {nan, 0, 0}},
                                        {.impact_m = {3, 0, 0}}}) {
    const auto seeds = make_seeds(body, options);
    ASSERT_FALSE(seeds);
    EXPECT_EQ(seeds.error().kind, ErrorKind::bad_input);
    EXPECT_GT(seeds.error().message.size(), 30u);
  }
}

}  // namespace
}  // namespace ringdown::test
