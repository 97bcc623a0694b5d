// Walls that become thicker or thinner: of a plate and of a piece of a tube, whose scaled forms are formulas.
#include "engine/mesh/surface/wall_scale.h"

#include "tests/fem/sample_meshes.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>

namespace ringdown {
namespace {

constexpr double kLength = 0.09, kWidth = 0.06, kThickness = 0.005;

// A plate that lies askew; its axes are the columns of this matrix.
Eigen::Matrix3d askew() {
  return (Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()))
      .toRotationMatrix();
}

mesh::TetMesh plate(int order) {
  mesh::TetMesh plate = mesh::to_order(test::box_mesh({18, 12, 2}, {kLength, kWidth, kThickness}), order);
  plate.nodes = (plate.nodes * askew().transpose()).eval();
  return plate;
}

Eigen::RowVector3d extents(const mesh::TetMesh& plate) {
  const mesh::Points along = plate.nodes * askew();
  return along.colwise().maxCoeff() - along.colwise().minCoeff();
}

TEST(WallScale, APlateBecomesThickerAndNoWider) {
  for (const int order : {1, 2}) {
    for (const double factor : {0.7, 1.0, 1.3}) {
      mesh::TetMesh scaled = plate(order);
      const double volume = mesh::volume_of(scaled);
      ASSERT_TRUE(mesh::scale_walls(scaled, factor, "plate"));
      const Eigen::RowVector3d size = extents(scaled);
      EXPECT_NEAR(size[2] / kThickness, factor, 1e-4) << order;
      EXPECT_NEAR(size[0] / kLength, 1, 1e-5) << order;
      EXPECT_NEAR(size[1] / kWidth, 1, 1e-5) << order;
      EXPECT_NEAR(mesh::volume_of(scaled) / volume, factor, 1e-4) << order;
    }
  }
}

// The plate, bent to a third of a tube: the middle of its wall keeps its radius.
TEST(WallScale, TheMiddleOfACurvedWallStays) {
  constexpr double kRadius = 0.04, kFactor = 1.25;
  mesh::TetMesh bent = test::box_mesh({24, 12, 2}, {kLength, kWidth, kThickness});
  const auto radius = [](const Eigen::RowVector3d& at) { return std::hypot(at[0], at[2]); };
  for (Eigen::Index n = 0; n < bent.nodes.rows(); ++n) {
    const double angle = bent.nodes(n, 0) / kRadius, r = kRadius + bent.nodes(n, 2) - 0.5 * kThickness;
    bent.nodes.row(n) << r * std::sin(angle), bent.nodes(n, 1), r * std::cos(angle);
  }
  mesh::TetMesh scaled = bent;
  ASSERT_TRUE(mesh::scale_walls(scaled, kFactor, "tube"));
  const double half = 0.5 * kThickness;
  for (Eigen::Index n = 0; n < bent.nodes.rows(); ++n) {
    const double before = radius(bent.nodes.row(n)) - kRadius, after = radius(scaled.nodes.row(n)) - kRadius;
    EXPECT_NEAR(after / half, kFactor * before / half, 0.03) << bent.nodes.row(n);
    EXPECT_NEAR(scaled.nodes(n, 1), bent.nodes(n, 1), 0.02 * half);
  }
  EXPECT_NEAR(mesh::volume_of(scaled) / mesh::volume_of(bent), kFactor, 0.01);
}

}  // namespace
}  // namespace ringdown
