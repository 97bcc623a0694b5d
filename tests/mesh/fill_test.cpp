#include "engine/mesh/fill.h"

#include "engine/mesh/surface/remesh.h"
#include "engine/mesh/surface/surface_check.h"
#include "engine/mesh/surface/surface_distance.h"
#include "engine/mesh/tet_mesh.h"
#include "tests/mesh/sample_surfaces.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace ringdown {
namespace {

double volume(const mesh::TetMesh& mesh) {
  double sum = 0;
  for (const auto& point : mesh::tet_quadrature(6)) {
    const mesh::ReferenceGradient gradient = mesh::interpolation_gradient(mesh.order(), point.barycentric);
    for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
      sum += point.weight * mesh::jacobian(mesh::nodes_of(mesh, e), gradient).determinant() / 6;
    }
  }
  return sum;
}

TEST(Fill, EveryShapeKeepsItsVolumeAtAnySize) {
  const std::pair<const char*, mesh::TriangleMesh> bodies[] = {{"box", test::box({0, 0, 0}, {0.1, 0.08, 0.06})},
                                                               {"cylinder", test::cylinder(0.03, 0.1, 48)},
                                                               {"tube", test::tube(0.025, 0.03, 0.1, 48)},
                                                               {"cup", test::cup(0.04, 0.09, 0.004, 48)},
                                                               {"bowl", test::bowl(0.05, 0.005, 48)},
                                                               {"sphere", test::sphere(0.05, 32)},
                                                               {"torus", test::torus(0.05, 0.012, 24)},
                                                               {"L", test::l_shape(0.2, 0.05, 0.02)}};
  for (const auto& [name, body] : bodies) {
    const double exact = mesh::diagnose(body).volume_m3, wall = mesh::wall_thickness(body);
    for (const double size : {0.0, 0.015}) {
      const auto filled = mesh::fill(body, {.size_m = size, .order = 2, .wall_m = wall}, name);
      ASSERT_TRUE(filled) << name << " " << size << ": " << filled.error().message;
      EXPECT_EQ(filled->note, "") << name << " " << size;
      EXPECT_NEAR(volume(filled->mesh.mesh) / exact, 1, size > 0 ? 0.015 : 1e-9) << name << " " << size;
      EXPECT_EQ(filled->mesh.pieces, 1) << name;
    }
  }
}

TEST(Fill, CavitiesStayEmptyAndFurtherShellsArePieces) {
  const auto block = test::box({0, 0, 0}, {0.3, 0.2, 0.1});
  const auto hollow = test::united(block, test::inside_out(test::box({0.1, 0.05, 0.02}, {0.2, 0.15, 0.08})));
  const auto filled = mesh::fill(test::united(hollow, test::moved(test::sphere(0.05, 16), {1, 0, 0})),
                                 {.size_m = 0.05, .order = 1, .wall_m = 0.02}, "both");
  ASSERT_TRUE(filled) << filled.error().message;
  EXPECT_EQ(filled->mesh.pieces, 2);
  const double ball = mesh::diagnose(test::sphere(0.05, 16)).volume_m3;
  EXPECT_NEAR(volume(filled->mesh.mesh) / (0.006 - 0.0006 + ball), 1, 0.02);
}

TEST(Fill, TheSizeDecidesTheNumberOfElements) {
  const auto body = test::box({0, 0, 0}, {0.1, 0.08, 0.06});
  const auto coarse = mesh::fill(body, {.size_m = 0.03, .order = 1}, "box");
  const auto fine = mesh::fill(body, {.size_m = 0.01, .order = 1}, "box");
  ASSERT_TRUE(coarse && fine);
  EXPECT_GT(fine->mesh.mesh.elements.rows(), 8 * coarse->mesh.mesh.elements.rows());
  EXPECT_LT(mesh::quality_of(fine->mesh.mesh).longest_edge_m, 0.02);
  EXPECT_GT(mesh::quality_of(fine->mesh.mesh).smallest_angle_deg, 5);
}

TEST(Remesh, RemeshingKeepsSharpEdges) {
  const auto made = mesh::remesh(test::box({0, 0, 0}, {0.1, 0.08, 0.06}), {.longest_m = 0.015, .shortest_m = 0.005});
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_LT(*std::max_element(made->deviations_m.begin(), made->deviations_m.end()), 1e-9);
  EXPECT_NEAR(mesh::diagnose(made->mesh).volume_m3, 0.1 * 0.08 * 0.06, 1e-12);
}

TEST(WallThickness, TheThicknessOfKnownWallsIsFound) {
  EXPECT_NEAR(mesh::wall_thickness(test::box({0, 0, 0}, {0.3, 0.2, 0.01})), 0.01, 1e-9);
  EXPECT_NEAR(mesh::wall_thickness(test::cup(0.04, 0.09, 0.003, 48)), 0.003, 1e-4);
  EXPECT_NEAR(mesh::wall_thickness(test::bowl(0.05, 0.005, 48)), 0.005, 2e-4);
}

}  // namespace
}  // namespace ringdown
