#include "engine/mesh/surface/surface_gap.h"

#include "engine/mesh/face_points.h"
#include "engine/mesh/surface/smooth_facets.h"
#include "engine/mesh/surface/surface_distance.h"
#include "tests/fem/sample_meshes.h"
#include "tests/mesh/sample_surfaces.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown {
namespace {

// The mesh is a box; its surface is one that is `beyond` larger on all sides, moved so that both have one middle.
Eigen::VectorXd gaps_of_box(double beyond, bool soup, const std::vector<int>& missing) {
  const mesh::TetMesh box = test::box_mesh({3, 3, 2}, {0.1, 0.08, 0.06});
  const Eigen::RowVector3d margin(beyond, beyond, beyond);
  const auto surface = test::without(
      test::subdivided(test::subdivided(test::box(-margin, Eigen::RowVector3d(0.1, 0.08, 0.06) + margin))), missing);
  return mesh::surface_gaps(box, surface, 0.01, soup);
}

TEST(SurfaceGap, ASurfaceFartherOutOrInIsFoundByBothWays) {
  for (const bool soup : {false, true}) {
    for (const double beyond : {0.0, 0.0013, -0.0013}) {
      const Eigen::VectorXd gaps = gaps_of_box(beyond, soup, {});
      EXPECT_NEAR(gaps.maxCoeff(), beyond, 1e-8) << soup;
      EXPECT_NEAR(gaps.minCoeff(), beyond, 1e-8) << soup;
    }
  }
}

// Its triangles have areas of 2e-18 m2, less than coordinates of 0.1 m are rounded by.
TEST(SurfaceGap, ABoxOfNanometresHasItsThickness) {
  const mesh::TriangleMesh box = test::box({0.1, 0.1, 0.1}, {0.1 + 2e-9, 0.1 + 2e-9, 0.1 + 1e-9});
  EXPECT_NEAR(mesh::wall_thickness(box), 1e-9, 1e-14);
}

// Across a hole of one triangle of 192 the winding number still falls through one half near where the surface was.
TEST(SurfaceGap, AHoleIsNoGap) {
  const Eigen::VectorXd gaps = gaps_of_box(0.001, true, {50});
  EXPECT_LT((gaps.array() - 0.001).abs().maxCoeff(), 0.005);
  EXPECT_GT(((gaps.array() - 0.001).abs() < 1e-6).count(), gaps.size() * 9 / 10);
}

TEST(SurfaceGap, GapTimesAreaIsTheVolumeThatIsMissing) {
  const mesh::TetMesh box = test::box_mesh({6, 2, 2}, {0.1, 0.04, 0.04});
  const auto larger = test::box({0, 0, -0.002}, {0.1, 0.04, 0.04});
  const Eigen::VectorXd gaps = mesh::surface_gaps(box, larger, 0.02, false);
  EXPECT_NEAR(gaps.dot(mesh::face_points(box).areas), 0.002 * 0.1 * 0.04, 1e-9);
}

Eigen::RowVector3d corner(const mesh::TriangleMesh& surface, Eigen::Index t, int i) {
  return surface.nodes.row(surface.triangles(t, i));
}

// The middles of the longest sides of a tube's walls lie on the walls' flat sides, half way from edge to edge: there a
// circle rises above its chord by r (1 - cos(pi / n)), away from the axis outside as well as inside.
TEST(SmoothFacets, TheSidesOfATubeRiseToItsCircles) {
  constexpr int kSides = 24;
  const mesh::TriangleMesh tube = test::tube(0.03, 0.04, 0.2, kSides);
  const mesh::SmoothFacets facets(tube);
  int walls = 0;
  for (Eigen::Index t = 0; t < tube.triangles.rows(); ++t) {
    const Eigen::RowVector3d a = corner(tube, t, 0), b = corner(tube, t, 1), c = corner(tube, t, 2);
    const Eigen::RowVector3d normal = (b - a).cross(c - a).normalized();
    Eigen::RowVector3d middle = (a + b) / 2;
    for (const Eigen::RowVector3d& other : {Eigen::RowVector3d((b + c) / 2), Eigen::RowVector3d((c + a) / 2)}) {
      if (other.head<2>().norm() < middle.head<2>().norm() - 1e-9) middle = other;
    }
    const Eigen::RowVector3d rise = facets.rise(t, middle);
    if (std::abs(normal[2]) > 0.5) {
      EXPECT_LT(rise.norm(), 1e-12) << "an end is flat";
      continue;
    }
    const double radius = a.head<2>().norm() > 0.035 ? 0.04 : 0.03;
    const double wanted = radius * (1 - std::cos(std::numbers::pi / kSides));
    const Eigen::RowVector3d away = middle.normalized().cwiseProduct(Eigen::RowVector3d(1, 1, 0)).normalized();
    EXPECT_NEAR(rise.dot(away) / wanted, 1, 0.03);
    ++walls;
  }
  EXPECT_EQ(walls, 4 * kSides);
}

struct Enclosed {
  double flat_m3 = 0, risen_m3 = 0;  // by the facets, and between them and the surface that they stand for
};

Enclosed enclosed(const mesh::TriangleMesh& surface) {
  const mesh::SmoothFacets facets(surface);
  Enclosed sum;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const Eigen::RowVector3d a = corner(surface, t, 0), b = corner(surface, t, 1), c = corner(surface, t, 2);
    sum.flat_m3 += a.dot(b.cross(c)) / 6;
    const double area = 0.5 * (b - a).cross(c - a).norm();
    // Quadratic polynomials are integrated exactly by the middles of the sides.
    for (const Eigen::RowVector3d& at :
         {Eigen::RowVector3d((a + b) / 2), Eigen::RowVector3d((b + c) / 2), Eigen::RowVector3d((c + a) / 2)}) {
      sum.risen_m3 += area / 3 * facets.rise(t, at).dot((b - a).cross(c - a).normalized());
    }
  }
  return sum;
}

TEST(SmoothFacets, RisesOverABallAreTheVolumeThatItsFacetsLack) {
  const Enclosed ball = enclosed(test::sphere(0.1, 40));
  EXPECT_NEAR(ball.risen_m3 / (4.0 / 3 * std::numbers::pi * 1e-3 - ball.flat_m3), 1, 0.05);
}

// A ball with a horn, cut at about equal lengths: around the tip of the horn all edges are more than three times
// sharper than most of the body's.
TEST(SmoothFacets, WhereABodyBendsMostItsFacetsStandForACurveToo) {
  constexpr double kSharp = 40, kHeight = 1;
  const auto reach = [](double cosine) { return 1 + kHeight * std::exp(kSharp * (cosine - 1)); };
  mesh::TriangleMesh body = test::sphere(1, 400);
  for (Eigen::Index n = 0; n < body.nodes.rows(); ++n) {
    body.nodes.row(n) *= reach(body.nodes(n, 0) / body.nodes.row(n).norm());
  }
  double round_m3 = 0;  // the integral of 2 pi / 3 reach^3 over the cosine, by the rule of midpoints
  constexpr int kParts = 20'000;
  for (int part = 0; part < kParts; ++part) {
    round_m3 += 2 * std::numbers::pi / 3 * std::pow(reach(-1 + 2 * (part + 0.5) / kParts), 3) * 2 / kParts;
  }
  const Enclosed facets = enclosed(body);
  EXPECT_NEAR(facets.risen_m3 / (round_m3 - facets.flat_m3), 1, 0.1) << "long triangles on the horn's sides rise less";
}

// A puck whose upper edge is rounded by a few narrow strips: its flat top stays flat.
TEST(SmoothFacets, AFlatFaceBesideARoundedEdgeIsFlat) {
  const double r = 0.002, s = std::sqrt(0.5) * r;
  const mesh::TriangleMesh puck =
      test::lathe({{0, 0}, {0.05, 0}, {0.05, 0.02 - r}, {0.05 - r + s, 0.02 - r + s}, {0.05 - r, 0.02}, {0, 0.02}}, 48);
  const mesh::SmoothFacets facets(puck);
  double highest = 0;
  for (Eigen::Index t = 0; t < puck.triangles.rows(); ++t) {
    const Eigen::RowVector3d middle = (corner(puck, t, 0) + corner(puck, t, 1) + corner(puck, t, 2)) / 3;
    if (middle[2] > 0.02 - 1e-9) highest = std::max(highest, facets.rise(t, middle).norm());
  }
  EXPECT_LT(highest, 0.01 * r);
}

// A cone on a cylinder, both of 96 sides: the corner of 20 degrees where they meet belongs to the body, though facets
// meet there at less than they would on a coarser cylinder.
TEST(SmoothFacets, ABluntCornerOfAFineLatheIsNoCurve) {
  const double slope = std::tan(20 * std::numbers::pi / 180);
  const mesh::TriangleMesh post =
      test::lathe({{0, 0}, {0.04, 0}, {0.04, 0.05}, {0.04 - 0.05 * slope, 0.1}, {0, 0.1}}, 96);
  const mesh::SmoothFacets facets(post);
  double highest = 0;
  for (Eigen::Index t = 0; t < post.triangles.rows(); ++t) {
    const Eigen::RowVector3d middle = (corner(post, t, 0) + corner(post, t, 1) + corner(post, t, 2)) / 3;
    highest = std::max(highest, facets.rise(t, middle).norm());
  }
  EXPECT_LT(highest, 0.04 * (1 - std::cos(std::numbers::pi / 96)));
  EXPECT_GT(highest, 0.5 * 0.04 * (1 - std::cos(std::numbers::pi / 96)));
}

}  // namespace
}  // namespace ringdown
