// The flow of heat in bent bodies against closed forms and against a complex solve at each frequency.
#include "engine/fem/heat_flow.h"
#include "tests/fem/sample_meshes.h"

#include <Eigen/SparseLU>

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <vector>

namespace ringdown {
namespace {

using Complex = std::complex<double>;

// Lifshitz & Roukes, Phys. Rev. B 61, 2000, eq. 41: eta over E alpha^2 T / (rho c) of a bar bent across its thickness
// h, with xi = h sqrt(omega rho c / (2 k)).
double lifshitz_roukes(double xi) {
  return 6 / (xi * xi) - 6 / (xi * xi * xi) * (std::sinh(xi) + std::sin(xi)) / (std::cosh(xi) + std::cos(xi));
}

// omega in units where conductivity and capacity are 1.
double omega_of(double xi, double thickness) { return 2 * xi * xi / (thickness * thickness); }

double eta_of(const Eigen::VectorXd& pairs, double omega) {
  double eta = 0;
  for (Eigen::Index j = 0; j < pairs.size(); j += 2) {
    if (!(pairs[j] > 0)) continue;
    const double x = omega / pairs[j + 1];
    eta += pairs[j] * x / (1 + x * x);
  }
  return eta;
}

// The loss factor at one frequency by a complex factorization.
double solved_eta(const fem::HeatProblem& problem, const Eigen::VectorXd& warmth, double lambda, double omega) {
  const Eigen::SparseMatrix<Complex> pencil =
      problem.conduction().cast<Complex>() + Complex(0, omega) * problem.capacity().cast<Complex>();
  Eigen::SparseLU<Eigen::SparseMatrix<Complex>> factors(pencil);
  const Eigen::VectorXcd temperature = factors.solve(Complex(0, -omega) * warmth.cast<Complex>());
  return -(warmth.cast<Complex>().transpose() * temperature)(0).imag() / lambda;
}

using Motion = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

struct Bent {
  mesh::TetMesh mesh;
  fem::Solid solid;
  Eigen::MatrixXd shape;
  double lambda = 0;  // phi^T K phi of the shape

  Bent(mesh::TetMesh box, int order, double nu, const Motion& motion)
      : mesh(mesh::to_order(box, order)), solid(fem::Elastic{1, nu, 1}), shape(3 * mesh.nodes.rows(), 1) {
    for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n)
      shape.col(0).segment<3>(3 * n) = motion(mesh.nodes.row(n).transpose());
    const auto element = order == 2 ? fem::Element::kTet10 : fem::Element::kTet20;
    const fem::System system = fem::assemble(mesh, solid, element).value();
    lambda = shape.col(0).dot(system.stiffness.selfadjointView<Eigen::Lower>() * shape.col(0));
  }

  [[nodiscard]] fem::HeatSource source(double wall) const { return {mesh, solid, parts, part_of, wall}; }

  std::vector<fem::HeatRatios> parts{fem::HeatRatios{}};
  std::vector<std::int32_t> part_of;
};

Motion bent_bar(double middle) {
  return [middle](const Eigen::Vector3d& x) { return Eigen::Vector3d(-(x[2] - middle) * x[0], 0, 0.5 * x[0] * x[0]); };
}

TEST(HeatFlow, AThinBarLosesWhatLifshitzAndRoukesSay) {
  constexpr double kThick = 0.02;
  for (const int order : {2, 3}) {
    const Bent bar(test::box_mesh({10, 1, 2}, {1, 0.1, kThick}), order, 0, bent_bar(kThick / 2));
    const fem::HeatProblem problem(bar.source(kThick));
    const Eigen::VectorXd warmth = problem.warmth(bar.shape);
    const Eigen::MatrixXd pairs =
        fem::heat_relaxations(bar.source(kThick), bar.shape, Eigen::VectorXd::Constant(1, bar.lambda)).value();
    for (const double xi : {0.3, 1.0, 2.2, 5.0, 10.0}) {
      const double omega = omega_of(xi, kThick);
      EXPECT_NEAR(solved_eta(problem, warmth, bar.lambda, omega) / lifshitz_roukes(xi), 1, 0.01) << xi;
      EXPECT_NEAR(eta_of(pairs.col(0), omega) / lifshitz_roukes(xi), 1, 0.02) << xi;
    }
  }
}

// A bake has one element across the wall.
TEST(HeatFlow, OneElementAcrossTheWallIsEnough) {
  constexpr double kThick = 0.02;
  const Bent bar(test::box_mesh({10, 1, 1}, {1, 0.1, kThick}), 3, 0, bent_bar(kThick / 2));
  const Eigen::MatrixXd pairs =
      fem::heat_relaxations(bar.source(kThick), bar.shape, Eigen::VectorXd::Constant(1, bar.lambda)).value();
  for (const double xi : {0.3, 1.0, 2.2, 5.0, 10.0})
    EXPECT_NEAR(eta_of(pairs.col(0), omega_of(xi, kThick)) / lifshitz_roukes(xi), 1, 0.03) << xi;
}

// A plate that curves one way loses (1 + nu) / (1 - nu) times as much as a bar, one that curves alike in both
// directions 2 / (1 - nu) times: from the stresses of a thin plate, whose thickness adds -nu / (1 - nu) of its stretch.
TEST(HeatFlow, APlateLosesMoreByPoissonsRatio) {
  constexpr double kThick = 0.02, kNu = 0.3;
  const double middle = kThick / 2, squeeze = kNu / (1 - kNu);
  const Bent cylinder(test::box_mesh({8, 8, 2}, {0.4, 0.4, kThick}), 3, kNu, [&](const Eigen::Vector3d& x) {
    const double z = x[2] - middle;
    return Eigen::Vector3d(-z * x[0], 0, 0.5 * (x[0] * x[0] + squeeze * z * z));
  });
  const Bent bowl(test::box_mesh({8, 8, 2}, {0.4, 0.4, kThick}), 3, kNu, [&](const Eigen::Vector3d& x) {
    const double z = x[2] - middle;
    return Eigen::Vector3d(-z * x[0], -z * x[1], 0.5 * (x[0] * x[0] + x[1] * x[1]) + squeeze * z * z);
  });
  for (const auto& [plate, factor] : {std::pair{&cylinder, (1 + kNu) / (1 - kNu)}, {&bowl, 2 / (1 - kNu)}}) {
    const Eigen::MatrixXd pairs =
        fem::heat_relaxations(plate->source(kThick), plate->shape, Eigen::VectorXd::Constant(1, plate->lambda)).value();
    for (const double xi : {0.3, 1.0, 2.2, 5.0, 10.0})
      EXPECT_NEAR(eta_of(pairs.col(0), omega_of(xi, kThick)) / (factor * lifshitz_roukes(xi)), 1, 0.02) << xi;
  }
}

TEST(HeatFlow, NothingFlowsInATwistedRodNorWhereAllIsPressedAlike) {
  const Bent twisted(test::box_mesh({4, 2, 2}, {1, 0.1, 0.1}), 3, 0.3, [](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(0, -x[0] * (x[2] - 0.05), x[0] * (x[1] - 0.05));
  });
  const Bent pressed(test::box_mesh({3, 3, 3}, {1, 1, 1}), 3, 0.3, [](const Eigen::Vector3d& x) { return x; });
  for (const Bent* body : {&twisted, &pressed}) {
    const Eigen::MatrixXd pairs =
        fem::heat_relaxations(body->source(0.1), body->shape, Eigen::VectorXd::Constant(1, body->lambda)).value();
    for (const double omega : {1.0, 100.0, 1e4}) EXPECT_LT(eta_of(pairs.col(0), omega), 1e-10);
  }
}

// Any motion of a body of two materials: the pairs are held against the factorized pencil.
TEST(HeatFlow, FewPairsHoldAtAllFrequencies) {
  Bent body(test::box_mesh({6, 3, 2}, {0.6, 0.2, 0.05}), 3, 0.3, [](const Eigen::Vector3d& x) {
    const double z = x[2] - 0.025, y = x[1] - 0.1;
    return Eigen::Vector3d(-z * 3 * x[0] * x[0] - y * x[0], y * y * x[0], x[0] * x[0] * x[0] + 0.3 * x[0] * y);
  });
  body.parts.push_back({.expansion = 0.5, .conductivity = 2, .capacity = 1.5});
  for (Eigen::Index e = 0; e < body.mesh.elements.rows(); ++e)
    body.part_of.push_back(body.mesh.nodes(body.mesh.elements(e, 0), 0) < 0.3 ? 0 : 1);
  const fem::HeatProblem problem(body.source(0.05));
  const Eigen::VectorXd warmth = problem.warmth(body.shape);
  const Eigen::MatrixXd pairs =
      fem::heat_relaxations(body.source(0.05), body.shape, Eigen::VectorXd::Constant(1, body.lambda)).value();
  for (const double xi : {0.5, 1.0, 2.0, 4.0, 8.0}) {
    const double omega = omega_of(xi, 0.05);
    EXPECT_NEAR(eta_of(pairs.col(0), omega) / solved_eta(problem, warmth, body.lambda, omega), 1, 0.03) << xi;
  }
}

TEST(HeatFlow, CanBeCancelled) {
  const Bent bar(test::box_mesh({2, 1, 1}, {1, 0.1, 0.1}), 3, 0, bent_bar(0.05));
  const auto pairs = fem::heat_relaxations(bar.source(0.1), bar.shape, Eigen::VectorXd::Constant(1, bar.lambda),
                                           [](std::string_view, double) { return false; });
  ASSERT_FALSE(pairs);
  EXPECT_EQ(pairs.error().kind, ErrorKind::cancelled);
}

}  // namespace
}  // namespace ringdown
