// The nonlinear terms of modes from tetrahedra, against von Karman's plate by polynomials (von_karman.h), published
// coefficients of the free disc, and the laws that they obey.
#include "engine/bake/nonlinear_modes.h"
#include "engine/solve/eigensolver.h"
#include "tests/bake/von_karman.h"
#include "tests/fem/sample_meshes.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace ringdown::bake {
namespace {

struct Solved {
  mesh::TetMesh mesh;
  solve::Eigenmodes modes;
  NonlinearModes nonlinear;
  Eigen::VectorXd lambda;  // of the elastic modes
};

Solved solved(mesh::TetMesh mesh, const fem::Elastic& elastic, double top_hz, int count) {
  const auto system = fem::assemble(mesh, elastic, test::element_of(mesh));
  const double top = std::pow(2 * std::numbers::pi * top_hz, 2);
  Solved result{std::move(mesh), solve::solve_modes(*system, {.highest_lambda = top, .rigid = 6}).value(), {}, {}};
  result.lambda = result.modes.lambda.tail(result.modes.lambda.size() - 6);
  result.nonlinear = find_nonlinear(result.mesh, elastic, *system, result.modes.lambda, result.modes.shapes, 6,
                                    std::min<int>(count, static_cast<int>(result.lambda.size())))
                         .value();
  return result;
}

constexpr fem::Elastic kSteel{200e9, 0.3, 7850};

// A disc of radius 1 in the plane and thickness 1, from a box: squares about the middle become circles. `cells` is
// even.
mesh::TetMesh disc_mesh(int cells) {
  mesh::TetMesh mesh = mesh::to_order(test::box_mesh({cells, cells, 1}, {2, 2, 1}), 3);
  for (auto node : mesh.nodes.rowwise()) {
    const double x = node[0] - 1, y = node[1] - 1, square = std::max(std::abs(x), std::abs(y));
    const double scale = square > 0 ? 1 - square + square * square / std::hypot(x, y) : 1;
    node << scale * x, scale * y, node[2] - 0.5;
  }
  return mesh;
}

mesh::TetMesh plate_disc(int cells, double radius, double thickness) {
  mesh::TetMesh mesh = disc_mesh(cells);
  mesh.nodes = mesh.nodes * Eigen::Vector3d(radius, radius, thickness).asDiagonal();
  return mesh;
}

// A cap of a sphere, out to `angle` from its axis.
mesh::TetMesh cap(int cells, double sphere, double angle, double thickness) {
  mesh::TetMesh mesh = disc_mesh(cells);
  for (auto node : mesh.nodes.rowwise()) {
    const double at = angle * std::hypot(node[0], node[1]), turn = std::atan2(node[1], node[0]);
    const double r = sphere + thickness * node[2];
    node << r * std::sin(at) * std::cos(turn), r * std::sin(at) * std::sin(turn), r * std::cos(at) - sphere;
  }
  return mesh;
}

void expect_as_plate(const Solved& body, const test::PlateTerms& plate, double tolerance) {
  const Eigen::VectorXd own = own_hardening(body.nonlinear, body.lambda), expected = plate.own_hardening();
  for (Eigen::Index m = 0; m < own.size(); ++m) {
    EXPECT_NEAR(own[m] / expected[m], 1, tolerance)
        << "mode " << m << ", " << std::sqrt(body.lambda[m]) / (2 * std::numbers::pi) << " Hz";
  }
}

TEST(NonlinearModes, ThinBoxHardensAsVonKarmansPlate) {
  const double side = 0.2, thickness = 0.002;
  const Solved box = solved(mesh::to_order(test::box_mesh({8, 8, 1}, {side, side, thickness}), 3), kSteel, 900, 8);
  ASSERT_EQ(box.nonlinear.modes(), 8);
  expect_as_plate(box, test::von_karman_square(side, thickness, kSteel, 8), 0.01);
  EXPECT_LT(box.nonlinear.residual, 1e-3);
  EXPECT_LT(box.nonlinear.membrane_share, 1e-6);
}

TEST(NonlinearModes, FreeDiscHardensAsVonKarmansAndAsPublished) {
  constexpr fem::Elastic kUnit{12 * (1 - 0.38 * 0.38), 0.38, 1};  // D = 1, rho h = 1
  const test::PlateTerms oracle = test::von_karman_disc(1, 1, kUnit, 5);
  // modes (2,0) twice, (0,1), (3,0) twice; Gamma = 2 (sum of t_k^2) / (12 (1 - nu^2))
  const double gamma_2 = 2 * oracle.field(0, 0).squaredNorm() / kUnit.youngs_modulus_pa;
  const double gamma_0 = 2 * oracle.field(2, 2).squaredNorm() / kUnit.youngs_modulus_pa;
  EXPECT_NEAR(gamma_2, 1.898, 0.005);
  EXPECT_NEAR(gamma_0, 8.575, 0.02);
  const double radius = 0.15, thickness = 0.003;
  constexpr fem::Elastic kBrass{100e9, 0.38, 8500};
  const Solved disc = solved(plate_disc(8, radius, thickness), kBrass, 330, 5);
  ASSERT_EQ(disc.nonlinear.modes(), 5);
  expect_as_plate(disc, test::von_karman_disc(radius, thickness, kBrass, 5), 0.02);
}

// A plate's membrane follows its bending at once; where a shell is deep it has no need to.
TEST(NonlinearModes, CarriedStressTellsDeepShellsFromShallowOnes) {
  const auto carried = [](double sphere, double angle) {
    return solved(cap(6, sphere, angle, 0.001), kSteel, 1500, 6).nonlinear.carried_share;
  };
  EXPECT_LT(carried(1, 0.1), 0.15);
  EXPECT_GT(carried(0.1, 1.0), 0.3);
}

// The energy of a rotated, shifted body is that of the body.
TEST(NonlinearModes, TurningTheBodyChangesNothing) {
  const mesh::TetMesh plate = mesh::to_order(test::box_mesh({4, 3, 1}, {0.2, 0.14, 0.004}), 2);
  mesh::TetMesh turned = plate;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  turned.nodes = plate.nodes * turn.transpose();
  turned.nodes.rowwise() += Eigen::RowVector3d(0.3, -0.2, 0.1);
  const Solved a = solved(plate, kSteel, 2000, 6), b = solved(turned, kSteel, 2000, 6);
  const Eigen::VectorXd own_a = own_hardening(a.nonlinear, a.lambda), own_b = own_hardening(b.nonlinear, b.lambda);
  for (Eigen::Index m = 0; m < own_a.size(); ++m) EXPECT_NEAR(own_b[m] / own_a[m], 1, 1e-6) << m;
}

}  // namespace
}  // namespace ringdown::bake
