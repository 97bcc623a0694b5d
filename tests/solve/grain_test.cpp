// Solids with a grain against Rayleigh-Ritz, and against isotropic ones in disguise.
#include "engine/fem/assembly.h"
#include "engine/fem/element.h"
#include "engine/fem/error_estimate.h"
#include "engine/fem/mode_energy.h"
#include "engine/solve/eigensolver.h"
#include "tests/fem/grain_frequencies.h"
#include "tests/fem/sample_meshes.h"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <cstdlib>
#include <numbers>
#include <span>
#include <string_view>

namespace ringdown::grain_test {
namespace {

constexpr fem::Elastic kSteelLike{200e9, 0.3, 7850};

const fem::EngineeringConstants kSpruce{{11e9, 0.86e9, 0.47e9}, {0.37, 0.47, 0.44}, {0.70e9, 0.67e9, 0.033e9}};

Eigen::Matrix3d turn() {
  Eigen::Matrix3d axes;
  axes << 2, -1, 2, 2, 2, -1, -1, 2, 2;
  return axes / 3;
}

fem::Solid spruce(const Eigen::Matrix3d& axes) {
  const fem::Matrix6 stiffness = fem::rotated(fem::orthotropic_stiffness(kSpruce).value(), axes);
  return {{fem::Law{{1, 0, 430}, stiffness}}, {}};
}

// Smaller elements near the edges, where a body so soft in shear across its grain has strains that fade within
// millimetres.
mesh::TetMesh graded_block(int order) {
  mesh::TetMesh box = test::box_mesh({5, 8, 7}, {0.1, 0.08, 0.06});
  for (int axis = 0; axis < 3; ++axis) box = test::finer_at_ends(box, axis, true);
  return mesh::to_order(box, order);
}

struct Found {
  mesh::TetMesh mesh;
  Eigen::VectorXd lambda;
  Eigen::MatrixXd shapes;
};

Found solve_box(const mesh::TetMesh& mesh, const fem::Solid& solid, double top_hz) {
  const fem::System system = fem::assemble(mesh, solid, test::element_of(mesh)).value();
  const auto modes =
      solve::solve_modes(system, {.highest_lambda = std::pow(2 * std::numbers::pi * top_hz, 2), .rigid = 6});
  return {mesh, modes->lambda.tail(modes->lambda.size() - 6), modes->shapes.rightCols(modes->lambda.size() - 6)};
}

double worst(const Found& found, std::span<const double> exact) {
  double worst = 0;
  for (std::size_t m = 0; m < exact.size(); ++m) {
    const double hz = std::sqrt(found.lambda[static_cast<Eigen::Index>(m)]) / (2 * std::numbers::pi);
    worst = std::max(worst, std::abs(hz / exact[m] - 1));
  }
  return worst;
}

void expect_within_a_thousandth(const mesh::TetMesh& mesh, const Eigen::Matrix3d& axes, std::span<const double> exact) {
  const Found found = solve_box(mesh, spruce(axes), 1.02 * exact.back());
  const auto count = static_cast<Eigen::Index>(exact.size());
  ASSERT_GE(found.lambda.size(), count);
  const double off = worst(found, exact);
  const Eigen::VectorXd errors =
      fem::frequency_errors(mesh, spruce(axes), found.lambda.head(count), found.shapes.leftCols(count)).value();
  std::printf("%td modes within %.1e, estimated %.1e, %td unknowns\n", count, off, errors.maxCoeff(),
              3 * mesh.nodes.rows());
  EXPECT_LT(off, 1e-3);
  EXPECT_GT(errors.maxCoeff(), 0.5 * off);
  EXPECT_LT(errors.maxCoeff(), 10 * off + 1e-4);
}

TEST(Grain, ASpruceBlockHasTheFrequenciesOfRayleighRitz) {
  expect_within_a_thousandth(graded_block(4), Eigen::Matrix3d::Identity(), reference::kSpruceBlock);
}

// All 50 modes with RINGDOWN_STRESS=long.
TEST(Grain, ABlockCutAcrossItsGrainHasTheFrequenciesOfRayleighRitz) {
  const char* stress = std::getenv("RINGDOWN_STRESS");
  const bool all = stress && std::string_view(stress) == "long";
  const mesh::TetMesh box = test::box_mesh(all ? test::Cells{7, 7, 6} : test::Cells{5, 5, 4}, {0.1, 0.08, 0.06});
  expect_within_a_thousandth(mesh::to_order(box, 4), turn(),
                             std::span(reference::kTurnedSpruceBlock).first(all ? 50 : 16));
}

TEST(Grain, ASprucePlateHasTheFrequenciesOfRayleighRitz) {
  expect_within_a_thousandth(mesh::to_order(test::box_mesh({11, 13, 1}, {0.2, 0.15, 0.004}), 4),
                             Eigen::Matrix3d::Identity(), reference::kSprucePlate);
}

TEST(Grain, AnIsotropicSolidGivenByNineConstantsIsTheSameSolid) {
  const double e = kSteelLike.youngs_modulus_pa, nu = kSteelLike.poisson_ratio, g = e / (2 * (1 + nu));
  const fem::Matrix6 nine = fem::orthotropic_stiffness({{e, e, e}, {nu, nu, nu}, {g, g, g}}).value();
  EXPECT_LT((nine - fem::isotropic_stiffness(kSteelLike)).cwiseAbs().maxCoeff(), 1e-12 * e);
  const mesh::TetMesh mesh = test::bent(mesh::to_order(test::box_mesh({2, 2, 1}, {0.1, 0.08, 0.06}), 3), 5);
  const fem::Solid turned{{fem::Law{{1, 0, 7850}, fem::rotated(nine, turn())}}, {}};
  const fem::System a = fem::assemble(mesh, kSteelLike, fem::Element::kTet20).value(),
                    b = fem::assemble(mesh, turned, fem::Element::kTet20).value();
  EXPECT_LT((Eigen::MatrixXd(a.stiffness) - Eigen::MatrixXd(b.stiffness)).cwiseAbs().maxCoeff(),
            1e-12 * Eigen::MatrixXd(a.stiffness).cwiseAbs().maxCoeff());
}

// A body that is turned together with its grain has the same stiffness in turned coordinates.
TEST(Grain, TurningBodyAndGrainTogetherChangesNothing) {
  const mesh::TetMesh mesh = mesh::to_order(test::box_mesh({1, 1, 1}, {0.1, 0.08, 0.06}), 2);
  mesh::TetMesh turned = mesh;
  turned.nodes = mesh.nodes * turn().transpose();
  const Eigen::MatrixXd a = fem::assemble(mesh, spruce(Eigen::Matrix3d::Identity()), fem::Element::kTet10)->stiffness,
                        b = fem::assemble(turned, spruce(turn()), fem::Element::kTet10)->stiffness;
  const Eigen::MatrixXd whole_a = a.selfadjointView<Eigen::Lower>(), whole_b = b.selfadjointView<Eigen::Lower>();
  for (Eigen::Index i = 0; i < whole_a.rows(); i += 3) {
    for (Eigen::Index j = 0; j < whole_a.cols(); j += 3) {
      const Eigen::Matrix3d block = turn() * whole_a.block<3, 3>(i, j) * turn().transpose();
      ASSERT_LT((block - whole_b.block<3, 3>(i, j)).norm(), 1e-9 * whole_a.norm());
    }
  }
}

TEST(Grain, ConstantsOfNoStableSolidAreRefused) {
  EXPECT_FALSE(fem::orthotropic_stiffness({{11e9, 1e9, 1e9}, {0.4, 0.4, 1.01}, {1e9, 1e9, 1e8}}));
  EXPECT_FALSE(fem::orthotropic_stiffness({{11e9, -1e9, 1e9}, {0.4, 0.4, 0.4}, {1e9, 1e9, 1e8}}));
  EXPECT_TRUE(fem::orthotropic_stiffness(kSpruce));
}

// Exact by definition: with one loss factor for all moduli a mode loses that share of its energy; with a loss of shear
// alone, the share of its energy that is in shear, which central differences of lambda by the shear moduli give.
TEST(Grain, WhatAModeLosesIsTheSensitivityOfItsEigenvalue) {
  const mesh::TetMesh mesh = mesh::to_order(test::box_mesh({2, 2, 2}, {0.1, 0.08, 0.06}), 3);
  const Found found = solve_box(mesh, spruce(turn()), 6000);
  const auto energy = [&](const fem::Matrix6& law) {
    return fem::mode_energy(mesh, fem::Solid({fem::Law{{1, 0, 430}, fem::rotated(law, turn())}}, {}), {}, 1,
                            found.shapes);
  };
  using Six = Eigen::Array<double, 6, 1>;
  const fem::ModeEnergy all = energy(fem::lost_stiffness(kSpruce, Six::Ones()));
  EXPECT_LT((all.strain.row(0).transpose().array() / found.lambda.array() - 1).abs().maxCoeff(), 1e-6);
  EXPECT_LT((all.motion.array() - 1).abs().maxCoeff(), 1e-6);

  Six shear_only = Six::Zero();
  shear_only.tail<3>().setOnes();
  const fem::ModeEnergy shear = energy(fem::lost_stiffness(kSpruce, shear_only));
  constexpr double kStep = 1e-3;
  const auto changed = [&](double factor) {
    fem::EngineeringConstants constants = kSpruce;
    constants.shear *= factor;
    const fem::Matrix6 law = fem::rotated(fem::orthotropic_stiffness(constants).value(), turn());
    return solve_box(mesh, fem::Solid({fem::Law{{1, 0, 430}, law}}, {}), 6000).lambda;
  };
  const Eigen::VectorXd more = changed(1 + kStep), less = changed(1 - kStep);
  for (Eigen::Index m = 0; m < 10; ++m) {
    const double slope = (more[m] - less[m]) / (2 * kStep);
    EXPECT_NEAR(shear.strain(0, m) / found.lambda[m], slope / found.lambda[m], 1e-4) << m;
  }
}

}  // namespace
}  // namespace ringdown::grain_test
