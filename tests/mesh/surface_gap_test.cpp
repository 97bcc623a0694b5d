#include "engine/mesh/surface_gap.h"

#include "engine/mesh/face_points.h"
#include "tests/fem/sample_meshes.h"
#include "tests/mesh/sample_surfaces.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace ringdown
