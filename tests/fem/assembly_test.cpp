#include "engine/fem/assembly.h"

#include "engine/fem/element.h"
#include "tests/fem/sample_meshes.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace ringdown {
namespace {

constexpr fem::Elastic kSteel{200e9, 0.3, 7850};
const Eigen::Vector3d kSize(0.1, 0.08, 0.06);

Eigen::MatrixXd full(const fem::SparseMatrix& lower) { return Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>(); }

mesh::TetMesh curved_box() { return test::bent(mesh::to_quadratic(test::box_mesh({3, 2, 2}, kSize)), 5); }

// Pairs of a mesh and an element that suits it.
struct Case {
  mesh::TetMesh mesh;
  fem::Element element;
  double volume;
};

std::vector<Case> cases() {
  const mesh::TetMesh box = test::box_mesh({3, 2, 2}, kSize);
  return {{box, fem::Element::kTet4, kSize.prod()},
          {box, fem::Element::kTet4Lumped, kSize.prod()},
          {mesh::to_quadratic(box), fem::Element::kTet10, kSize.prod()}};
}

TEST(Assembly, IsTheSumOfItsElements) {
  const mesh::TetMesh mesh = curved_box();
  const fem::System system = fem::assemble(mesh, kSteel, fem::Element::kTet10).value();
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(system.unknowns(), system.unknowns());
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(mesh.nodes.rows(), mesh.nodes.rows());
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    mesh::Nodes10 nodes;
    for (int a = 0; a < 10; ++a) nodes.row(a) = mesh.nodes.row(mesh.elements(e, a));
    const fem::Stiffness10 k = fem::stiffness10(nodes, kSteel);
    const fem::Mass10 m = fem::consistent_mass10(nodes, kSteel.density_kg_m3);
    for (int a = 0; a < 10; ++a) {
      for (int b = 0; b < 10; ++b) {
        const int row = mesh.elements(e, a), column = mesh.elements(e, b);
        stiffness.block<3, 3>(3 * row, 3 * column) += k.block<3, 3>(3 * a, 3 * b);
        mass(row, column) += m(a, b);
      }
    }
  }
  EXPECT_LT((full(system.stiffness) - stiffness).norm(), 1e-13 * stiffness.norm());
  EXPECT_LT((Eigen::MatrixXd(system.node_mass) - mass).norm(), 1e-13 * mass.norm());
}

TEST(Assembly, MassSumsToTheVolumeTimesTheDensity) {
  for (const Case& one : cases()) {
    const fem::System system = fem::assemble(one.mesh, kSteel, one.element).value();
    EXPECT_NEAR(system.node_mass.sum(), 7850 * one.volume, 1e-12 * 7850 * one.volume);
  }
}

TEST(Assembly, RigidMotionCostsNoEnergy) {
  std::vector<Case> all = cases();
  all.push_back({curved_box(), fem::Element::kTet10, 0});
  for (const Case& one : all) {
    const fem::System system = fem::assemble(one.mesh, kSteel, one.element).value();
    const Eigen::MatrixXd stiffness = full(system.stiffness);
    for (int motion = 0; motion < 6; ++motion) {
      Eigen::VectorXd moved(system.unknowns());
      for (Eigen::Index n = 0; n < one.mesh.nodes.rows(); ++n) {
        const Eigen::Vector3d axis = Eigen::Vector3d::Unit(motion % 3), at = one.mesh.nodes.row(n) / 0.1;
        moved.segment<3>(3 * n) = motion < 3 ? axis : axis.cross(at);
      }
      EXPECT_LT((stiffness * moved).norm(), 1e-12 * stiffness.norm() * moved.norm()) << motion;
    }
  }
}

// The patch test: a body whose surface is displaced linearly must displace linearly inside, however its nodes lie.
TEST(Assembly, PassesThePatchTest) {
  const mesh::TetMesh box = test::shaken(test::box_mesh({3, 3, 3}, kSize), 0.004);
  const mesh::TetMesh quadratic = test::shaken(mesh::to_quadratic(box), 0.001);
  const Eigen::Matrix3d gradient = Eigen::Matrix3d::Random();
  for (const mesh::TetMesh& mesh : {box, quadratic}) {
    const auto element = mesh.quadratic() ? fem::Element::kTet10 : fem::Element::kTet4;
    const Eigen::MatrixXd stiffness = full(fem::assemble(mesh, kSteel, element).value().stiffness);
    Eigen::VectorXd exact(stiffness.rows());
    for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n) {
      exact.segment<3>(3 * n) = gradient * mesh.nodes.row(n).transpose();
    }
    std::vector<int> inside, outside;
    for (int n = 0; n < mesh.nodes.rows(); ++n) {
      const Eigen::Vector3d at = mesh.nodes.row(n).transpose().cwiseQuotient(kSize);
      const bool inner = (at.array() > 0.1).all() && (at.array() < 0.9).all();
      for (int i = 0; i < 3; ++i) (inner ? inside : outside).push_back(3 * n + i);
    }
    ASSERT_GT(inside.size(), 20u);
    const Eigen::MatrixXd coupling = stiffness(inside, outside), core = stiffness(inside, inside);
    const Eigen::VectorXd given = exact(outside);
    const Eigen::VectorXd found = core.ldlt().solve(-coupling * given);
    EXPECT_LT((found - exact(inside)).norm(), 1e-10 * exact.norm());
  }
}

TEST(Assembly, MassProductActsOnEachDirectionAlike) {
  const fem::System system = fem::assemble(curved_box(), kSteel, fem::Element::kTet10).value();
  const Eigen::MatrixXd x = Eigen::MatrixXd::Random(system.unknowns(), 3);
  const Eigen::MatrixXd y = fem::mass_times(system.node_mass, x), mass = Eigen::MatrixXd(system.node_mass);
  for (int i = 0; i < 3; ++i) {
    const auto part = Eigen::seqN(i, system.node_mass.rows(), 3);
    const Eigen::MatrixXd along = x(part, Eigen::all), found = y(part, Eigen::all);
    EXPECT_LT((found - mass * along).norm(), 1e-13 * y.norm());
  }
}

TEST(Assembly, RepeatsBitForBit) {
  const mesh::TetMesh mesh = curved_box();
  const fem::System a = fem::assemble(mesh, kSteel, fem::Element::kTet10).value();
  const fem::System b = fem::assemble(mesh, kSteel, fem::Element::kTet10).value();
  EXPECT_TRUE((a.stiffness.coeffs() == b.stiffness.coeffs()).all());
  EXPECT_TRUE((a.node_mass.coeffs() == b.node_mass.coeffs()).all());
}

TEST(Assembly, RefusesMaterialsThatAreNotStable) {
  const mesh::TetMesh box = test::box_mesh({1, 1, 1}, kSize);
  for (const fem::Elastic& bad : {fem::Elastic{0, 0.3, 1}, fem::Elastic{1e9, 0.5, 1}, fem::Elastic{1e9, -1, 1},
                                  fem::Elastic{1e9, 0.3, 0}, fem::Elastic{1e9, std::nan(""), 1}}) {
    EXPECT_FALSE(fem::assemble(box, bad, fem::Element::kTet4));
  }
}

// The course report's element, (vol/2)(lambda b_ia b_jb + mu b_ib b_ja + mu sum_k b_ik b_jk delta_ab), without its
// minus sign: the lost factor two makes every pitch six semitones too low.
TEST(ReportErrata, TheLostFactorTwoLowersEveryPitchBySixSemitones) {
  const mesh::TetMesh box = test::box_mesh({2, 2, 2}, kSize);
  const fem::System system = fem::assemble(box, kSteel, fem::Element::kTet4Lumped).value();
  Eigen::MatrixXd report = Eigen::MatrixXd::Zero(system.unknowns(), system.unknowns());
  for (Eigen::Index e = 0; e < box.elements.rows(); ++e) {
    Eigen::Matrix4d positions;
    for (int a = 0; a < 4; ++a) positions.col(a) << 1, box.nodes.row(box.elements(e, a)).transpose();
    const Eigen::Matrix4d inverse = positions.inverse();
    const Eigen::Matrix<double, 4, 3> b = inverse.rightCols<3>();
    const double half_volume = std::abs(positions.determinant()) / 6 / 2;
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        const Eigen::Matrix3d block = kSteel.lambda_pa() * b.row(i).transpose() * b.row(j) +
                                      kSteel.mu_pa() * b.row(j).transpose() * b.row(i) +
                                      kSteel.mu_pa() * b.row(i).dot(b.row(j)) * Eigen::Matrix3d::Identity();
        report.block<3, 3>(3 * box.elements(e, i), 3 * box.elements(e, j)) += half_volume * block;
      }
    }
  }
  const Eigen::MatrixXd mass =
      fem::mass_times(system.node_mass, Eigen::MatrixXd::Identity(system.unknowns(), system.unknowns()));
  const Eigen::VectorXd right =
      Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(full(system.stiffness), mass).eigenvalues();
  const Eigen::VectorXd reports = Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(report, mass).eigenvalues();
  for (Eigen::Index m = 6; m < right.size(); ++m) {
    EXPECT_NEAR(12 * std::log2(std::sqrt(right[m] / reports[m])), 6, 1e-6) << m;
  }
}

}  // namespace
}  // namespace ringdown
