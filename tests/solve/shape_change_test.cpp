// What a change of shape does to frequencies, against bodies that have the changed shape.
#include "engine/fem/shape_change.h"

#include "engine/fem/assembly.h"
#include "engine/solve/eigensolver.h"
#include "tests/fem/sample_meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace ringdown::shape_change_test {
namespace {

constexpr fem::Elastic kSteel{200e9, 0.3, 7850};

struct Solved {
  mesh::TetMesh mesh;
  mesh::Boundary surface;
  Eigen::VectorXd lambda;
  Eigen::MatrixXd shapes;  // at the surface's nodes
};

Solved solved(const mesh::TetMesh& straight, int order, double top_hz) {
  Solved body{mesh::to_order(straight, order), {}, {}, {}};
  body.surface = mesh::boundary_of(body.mesh);
  const fem::System system = fem::assemble(body.mesh, kSteel, test::element_of(body.mesh)).value();
  const auto modes = solve::solve_modes(system, {.highest_lambda = std::pow(2 * std::numbers::pi * top_hz, 2)}).value();
  const Eigen::Index elastic = modes.lambda.size() - modes.rigid;
  body.lambda = modes.lambda.tail(elastic);
  body.shapes.resize(3 * static_cast<Eigen::Index>(body.surface.nodes.size()), elastic);
  for (std::size_t n = 0; n < body.surface.nodes.size(); ++n) {
    body.shapes.middleRows<3>(3 * static_cast<Eigen::Index>(n)) =
        modes.shapes.block(3 * body.surface.nodes[n], modes.rigid, 3, elastic);
  }
  return body;
}

using Gap = std::function<double(const Eigen::Vector3d& at, const Eigen::Vector3d& normal)>;

Eigen::VectorXd relative_changes(const Solved& body, const Gap& gap) {
  const mesh::FacePoints points = mesh::face_points(body.mesh);
  Eigen::VectorXd gaps(points.positions.rows());
  for (Eigen::Index p = 0; p < gaps.size(); ++p) gaps[p] = gap(points.positions.row(p), points.normals.row(p));
  return fem::lambda_changes(points, body.surface, gaps, kSteel, body.lambda, body.shapes).cwiseQuotient(body.lambda);
}

TEST(FacePoints, TheyStandForTheWholeSurface) {
  for (int order = 1; order <= 4; ++order) {
    const mesh::TetMesh box = mesh::to_order(test::box_mesh({2, 3, 2}, {0.3, 0.2, 0.1}), order);
    const mesh::FacePoints points = mesh::face_points(box);
    EXPECT_NEAR(points.areas.sum(), 2 * (0.06 + 0.03 + 0.02), 1e-12) << order;
    const Eigen::VectorXd flow = points.positions.cwiseProduct(points.normals).rowwise().sum();
    EXPECT_NEAR(flow.dot(points.areas), 3 * 6e-3, 1e-12) << order << ": Gauss's theorem gives three volumes";
  }
}

// A body that is larger by a thousandth in all directions has eigenvalues lower by two thousandths: an identity between
// strain energy and motion at the surface, which holds for every mode.
TEST(ShapeChange, GrowingInAllDirectionsLowersEveryEigenvalueByTheSquare) {
  const Solved body = solved(test::box_mesh({5, 4, 3}, {0.1, 0.08, 0.06}), 3, 40e3);
  ASSERT_GE(body.lambda.size(), 20);
  const Eigen::VectorXd changes =
      relative_changes(body, [](const auto& at, const auto& normal) { return 1e-3 * at.dot(normal); });
  for (Eigen::Index m = 0; m < changes.size(); ++m) EXPECT_NEAR(changes[m] / -2e-3, 1, 0.02) << m;
}

TEST(ShapeChange, ALongerBarAndAThickerOneAreForeseen) {
  const Eigen::Vector3d size(0.2, 0.014, 0.01);
  const Solved bar = solved(test::box_mesh({20, 2, 2}, size), 3, 14e3);
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double kGrowth = 0.004;
    Eigen::Vector3d larger = size;
    larger[axis] *= 1 + kGrowth;
    const Solved other = solved(test::box_mesh({20, 2, 2}, larger), 3, 14e3);
    const Eigen::VectorXd changes = relative_changes(bar, [&](const auto& at, const auto& normal) {
      return at[axis] > size[axis] / 2 ? kGrowth * size[axis] * normal[axis] : 0;
    });
    for (Eigen::Index m = 0; m < 10; ++m) {
      const double truth = other.lambda[m] / bar.lambda[m] - 1;
      EXPECT_NEAR(changes[m], truth, 0.03 * std::abs(truth) + 1e-4) << axis << ' ' << m;
    }
  }
}

}  // namespace
}  // namespace ringdown::shape_change_test
