#include "engine/solve/eigensolver.h"

#include "engine/dense/decompositions.h"
#include "tests/fem/sample_meshes.h"

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <gtest/gtest.h>

#include <utility>

namespace ringdown::eigensolver_test {
namespace {

constexpr fem::Elastic kSteel{200e9, 0.3, 7850};
const Eigen::Vector3d kSize(0.1, 0.08, 0.06);

double lambda_of(double frequency_hz) { return std::pow(2 * M_PI * frequency_hz, 2); }

fem::System system_of(const mesh::TetMesh& mesh) {
  return fem::assemble(mesh::to_order(mesh, 2), kSteel, fem::Element::kTet10).value();
}

// Sylvester: as many negative pivots in L D L^T of K - lambda M as eigenvalues below lambda.
int modes_below(const fem::System& system, double lambda) {
  fem::SparseMatrix mass(system.unknowns(), system.unknowns());
  std::vector<Eigen::Triplet<double>> entries;
  for (int n = 0; n < system.node_mass.outerSize(); ++n) {
    for (fem::SparseMatrix::InnerIterator m(system.node_mass, n); m; ++m) {
      for (int i = 0; i < 3; ++i) {
        entries.emplace_back(static_cast<int>(3 * m.row() + i), static_cast<int>(3 * n + i), m.value());
      }
    }
  }
  mass.setFromTriplets(entries.begin(), entries.end());
  const fem::SparseMatrix shifted = system.stiffness - lambda * fem::SparseMatrix(mass.triangularView<Eigen::Lower>());
  const Eigen::SimplicialLDLT<fem::SparseMatrix, Eigen::Lower> factors(shifted);
  return static_cast<int>((factors.vectorD().array() < 0).count());
}

TEST(Eigensolver, EveryModeBelowTheTopIsFoundAndNoOther) {
  const fem::System system = system_of(test::box_mesh({4, 4, 3}, kSize));  // mirror-symmetric: many close pairs
  for (const double top_hz : {20e3, 60e3, 110e3}) {
    const auto modes = solve::solve_modes(system, {.highest_lambda = lambda_of(top_hz)});
    ASSERT_TRUE(modes) << modes.error().message;
    EXPECT_EQ(modes->lambda.size(), modes_below(system, lambda_of(top_hz))) << top_hz;
    EXPECT_LE(modes->lambda.maxCoeff(), lambda_of(top_hz));
    EXPECT_EQ(modes->rigid, 6);
  }
}

TEST(Eigensolver, ModesSolveTheEquationAndAreOrthonormal) {
  const fem::System system = system_of(test::box_mesh({4, 4, 3}, kSize));
  const auto modes = solve::solve_modes(system, {.highest_lambda = lambda_of(80e3)}).value();
  EXPECT_LT(modes.residuals.maxCoeff(), 1e-7);
  const Eigen::MatrixXd stiffness = Eigen::MatrixXd(system.stiffness).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd mass_shapes = fem::mass_times(system.node_mass, modes.shapes);
  const Eigen::MatrixXd gram = modes.shapes.transpose() * mass_shapes;
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(), 1e-10);
  const Eigen::MatrixXd error = stiffness * modes.shapes - mass_shapes * modes.lambda.asDiagonal();
  for (Eigen::Index m = 6; m < modes.lambda.size(); ++m) {
    const double residual = error.col(m).norm() / (modes.lambda[m] * mass_shapes.col(m).norm());
    EXPECT_NEAR(residual, modes.residuals[m], 1e-9);
  }
}

TEST(Eigensolver, ModesAgreeWithDenseAlgebra) {
  const fem::System system = system_of(test::box_mesh({3, 2, 2}, kSize));
  ASSERT_GT(system.unknowns(), 300) << "the solver itself would use dense algebra";
  const Eigen::MatrixXd stiffness = Eigen::MatrixXd(system.stiffness).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd mass =
      fem::mass_times(system.node_mass, Eigen::MatrixXd::Identity(system.unknowns(), system.unknowns()));
  const Eigen::VectorXd exact = dense::generalized_spectrum(stiffness, mass)->values;
  const auto modes = solve::solve_modes(system, {.highest_lambda = lambda_of(70e3)}).value();
  for (Eigen::Index m = 6; m < modes.lambda.size(); ++m) EXPECT_NEAR(modes.lambda[m] / exact[m], 1, 1e-9);
}

TEST(Eigensolver, ModesOfTinyMeshesAreFound) {
  mesh::TetMesh one{mesh::Points(4, 3), mesh::Indices(1, 4)};
  one.nodes << 0, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 0, 0, 0.1;
  one.elements << 0, 1, 2, 3;
  const fem::System system = fem::assemble(one, kSteel, fem::Element::kTet4Lumped).value();
  const auto modes = solve::solve_modes(system, {.highest_lambda = lambda_of(1e6)});
  ASSERT_TRUE(modes) << modes.error().message;
  EXPECT_EQ(modes->rigid, 6);
  EXPECT_EQ(modes->lambda.size(), 12);
}

TEST(Eigensolver, EachPieceHasSixRigidMotions) {
  const mesh::TetMesh box = test::box_mesh({3, 2, 2}, kSize);
  mesh::TetMesh far = box;
  far.nodes.array() += 1;
  const auto modes = solve::solve_modes(system_of(test::both(box, far)), {.highest_lambda = lambda_of(30e3)});
  ASSERT_TRUE(modes) << modes.error().message;
  EXPECT_EQ(modes->rigid, 12);
}

// Twelve equal boxes: every eigenvalue twelve times, more than a Lanczos block is wide.
TEST(Eigensolver, AllVectorsOfEigenvaluesOfHighMultiplicityAreFound) {
  const mesh::TetMesh box = test::box_mesh({2, 2, 2}, kSize);
  mesh::TetMesh many = box;
  for (int copy = 1; copy < 12; ++copy) {
    mesh::TetMesh moved = box;
    moved.nodes.col(0).array() += 0.2 * copy;
    many = test::both(many, moved);
  }
  const auto one = solve::solve_modes(system_of(box), {.highest_lambda = lambda_of(40e3)}).value();
  const auto all = solve::solve_modes(system_of(many), {.highest_lambda = lambda_of(40e3)});
  ASSERT_TRUE(all) << all.error().message;
  EXPECT_EQ(all->rigid, 72);
  ASSERT_EQ(all->lambda.size(), 12 * one.lambda.size());
  EXPECT_EQ(all->counted, all->lambda.size());
  for (Eigen::Index m = 72; m < all->lambda.size(); ++m) {
    EXPECT_NEAR(all->lambda[m] / one.lambda[m / 12], 1, 1e-9) << m;
  }
  EXPECT_LT(all->residuals.maxCoeff(), 1e-7);
  const Eigen::MatrixXd gram = all->shapes.transpose() * fem::mass_times(system_of(many).node_mass, all->shapes);
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(), 1e-9);
}

// Several slices, and the same from every method and number of threads.
TEST(Eigensolver, MethodsAgreeOnHundredsOfModes) {
  const fem::System system = system_of(test::box_mesh({5, 4, 3}, kSize));
  solve::EigenRequest request{.highest_lambda = lambda_of(150e3), .method = solve::Method::kSpectra};
  const auto reference = solve::solve_modes(system, request).value();
  ASSERT_GT(reference.lambda.size(), 200);
  request.method = solve::Method::kBlockLanczos;
  for (const int threads : {1, 2, 3}) {
    request.threads = threads;
    const auto found = solve::solve_modes(system, request);
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_EQ(found->lambda.size(), reference.lambda.size());
    for (Eigen::Index m = 6; m < found->lambda.size(); ++m) {
      EXPECT_NEAR(found->lambda[m] / reference.lambda[m], 1, 1e-9);
    }
    const Eigen::MatrixXd gram = found->shapes.transpose() * fem::mass_times(system.node_mass, found->shapes);
    EXPECT_LT((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(Eigensolver, UnknownsAndModesAloneChooseTheMethod) {
  const auto chosen = [](test::Cells cells, double top_hz, Eigen::VectorXd expected = {}) {
    const solve::EigenRequest request{.highest_lambda = lambda_of(top_hz), .expected_lambda = std::move(expected)};
    return solve::solve_modes(system_of(test::box_mesh(cells, kSize)), request).value().method;
  };
  EXPECT_EQ(chosen({1, 1, 1}, 20e3), solve::Method::kDense);
  EXPECT_EQ(chosen({4, 4, 3}, 30e3), solve::Method::kSpectra);
  EXPECT_EQ(chosen({4, 4, 3}, 30e3, Eigen::VectorXd::LinSpaced(500, 1, 1e9)), solve::Method::kSpectra) << "a hint";
  EXPECT_EQ(chosen({4, 4, 3}, 150e3), solve::Method::kBlockLanczos) << "many modes";
  EXPECT_EQ(chosen({8, 8, 6}, 20e3), solve::Method::kBlockLanczos) << "many unknowns";
}

// The bending modes of a square rod come in pairs of equal eigenvalues, between which no shift may fall.
TEST(Eigensolver, ExpectedEigenvaluesThatComeInPairsLeaveTheModesAccurate) {
  const fem::System system = system_of(test::box_mesh({2, 2, 20}, {0.01, 0.01, 0.2}));
  solve::EigenRequest request{.highest_lambda = lambda_of(60e3), .method = solve::Method::kBlockLanczos};
  const auto alone = solve::solve_modes(system, request).value();
  const Eigen::Index vibrations = alone.lambda.size() - 6;
  ASSERT_GT(vibrations, 20);
  request.expected_lambda = alone.lambda.tail(vibrations);
  for (Eigen::Index m = 12; m < alone.lambda.size(); ++m) {
    if (alone.lambda[m] < alone.lambda[m - 1] * 1.001) continue;  // a top inside a pair
    request.highest_lambda = 0.5 * (alone.lambda[m - 1] + alone.lambda[m]);
    const auto led = solve::solve_modes(system, request);
    ASSERT_TRUE(led) << led.error().message;
    ASSERT_EQ(led->lambda.size(), m);
    const auto ratios = led->lambda.tail(m - 6).array() / alone.lambda.segment(6, m - 6).array();
    EXPECT_LT((ratios - 1).abs().maxCoeff(), 1e-7) << m << " modes below the top";
  }
}

// A top in the middle of a family of equal eigenvalues cannot be told from one beside it; near one it can.
TEST(Eigensolver, TheTopOfTheBandMayLieVeryCloseToAMode) {
  const fem::System system = system_of(test::box_mesh({4, 3, 3}, kSize));
  const auto modes = solve::solve_modes(system, {.highest_lambda = lambda_of(60e3)}).value();
  const double last = modes.lambda[modes.lambda.size() - 1];
  const auto with = solve::solve_modes(system, {.highest_lambda = last * (1 + 1e-9)});
  const auto without = solve::solve_modes(system, {.highest_lambda = last * (1 - 1e-9)});
  ASSERT_TRUE(with) << with.error().message;
  ASSERT_TRUE(without) << without.error().message;
  EXPECT_EQ(with->lambda.size(), modes.lambda.size());
  EXPECT_EQ(without->lambda.size(), modes.lambda.size() - 1);
}

TEST(Eigensolver, EveryModeOfASmallMeshCanBeAskedFor) {
  const fem::System system = system_of(test::box_mesh({3, 2, 2}, kSize));
  const auto modes = solve::solve_modes(system, {.highest_lambda = 1e20, .method = solve::Method::kBlockLanczos});
  ASSERT_TRUE(modes) << modes.error().message;
  EXPECT_EQ(modes->lambda.size(), system.unknowns());
}

TEST(Eigensolver, ASolveRepeatsBitForBit) {
  const fem::System system = system_of(test::box_mesh({5, 4, 3}, kSize));
  const auto first = solve::solve_modes(system, {.highest_lambda = lambda_of(60e3)}).value();
  const auto second = solve::solve_modes(system, {.highest_lambda = lambda_of(60e3)}).value();
  EXPECT_TRUE(first.lambda == second.lambda);
  EXPECT_TRUE(first.shapes == second.shapes);
}

TEST(Eigensolver, ASolveStopsWhenToldTo) {
  const fem::System system = system_of(test::box_mesh({4, 3, 3}, kSize));
  for (const std::string_view stop_at : {"factors", "modes"}) {
    int calls_after = 0;
    bool stopped = false;
    const auto modes =
        solve::solve_modes(system, {.highest_lambda = lambda_of(60e3)}, [&](auto stage, double fraction) {
          EXPECT_GE(fraction, 0);
          EXPECT_LT(fraction, 1);
          calls_after += stopped;
          stopped = stopped || stage == stop_at;
          return !stopped;
        });
    ASSERT_FALSE(modes);
    EXPECT_EQ(modes.error().kind, ErrorKind::cancelled);
    EXPECT_EQ(calls_after, 0);
  }
}

TEST(Eigensolver, ASolveRefusesMoreModesThanAllowed) {
  const fem::System system = system_of(test::box_mesh({4, 3, 3}, kSize));
  const double top = lambda_of(80e3);
  const int present = modes_below(system, top) - 6;
  EXPECT_TRUE(solve::solve_modes(system, {.highest_lambda = top, .max_modes = present}));
  const auto fewer = solve::solve_modes(system, {.highest_lambda = top, .max_modes = present - 1});
  ASSERT_FALSE(fewer);
  EXPECT_NE(fewer.error().message.find("more than " + std::to_string(present - 1) + " modes"), std::string::npos);
}

}  // namespace
}  // namespace ringdown::eigensolver_test
