#include "engine/fem/assembly.h"

#include "engine/dense/decompositions.h"
#include "engine/fem/element.h"
#include "tests/fem/sample_meshes.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace ringdown::assembly_test {
namespace {

constexpr fem::Elastic kSteel{200e9, 0.3, 7850};
const Eigen::Vector3d kSize(0.1, 0.08, 0.06);

Eigen::MatrixXd full(const fem::SparseMatrix& lower) { return Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>(); }

mesh::TetMesh curved_box(int order) { return test::bent(mesh::to_order(test::box_mesh({3, 2, 2}, kSize), order), 5); }

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
          {mesh::to_order(box, 2), fem::Element::kTet10, kSize.prod()},
          {mesh::to_order(box, 3), fem::Element::kTet20, kSize.prod()},
          {mesh::to_order(box, 4), fem::Element::kTet35, kSize.prod()}};
}

bool is_inside(const Eigen::Vector3d& point) {
  const Eigen::Array3d at = point.cwiseQuotient(kSize).array();
  return (at > 1e-6).all() && (at < 1 - 1e-6).all();
}

// Straight elements of all forms in a box that keeps its own.
mesh::TetMesh uneven_box(int order) {
  const mesh::TetMesh box = test::box_mesh({3, 3, 3}, kSize), moved = test::shaken(box, 0.004);
  mesh::TetMesh uneven = box;
  for (Eigen::Index n = 0; n < box.nodes.rows(); ++n) {
    if (is_inside(box.nodes.row(n).transpose())) uneven.nodes.row(n) = moved.nodes.row(n);
  }
  return mesh::to_order(uneven, order);
}

class AssemblyOf : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Orders, AssemblyOf, testing::Range(1, mesh::kMaxOrder + 1));

TEST_P(AssemblyOf, TheWholeMatrixIsTheSumOfItsElements) {
  const mesh::TetMesh mesh = curved_box(GetParam());
  const fem::System system = fem::assemble(mesh, kSteel, test::element_of(mesh)).value();
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(system.unknowns(), system.unknowns());
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(mesh.nodes.rows(), mesh.nodes.rows());
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    const mesh::ElementNodes nodes = mesh::nodes_of(mesh, e);
    const Eigen::MatrixXd k = fem::stiffness(nodes, kSteel), m = fem::consistent_mass(nodes, kSteel.density_kg_m3);
    for (int a = 0; a < nodes.rows(); ++a) {
      for (int b = 0; b < nodes.rows(); ++b) {
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
  all.push_back({curved_box(2), fem::Element::kTet10, 0});
  all.push_back({curved_box(3), fem::Element::kTet20, 0});
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
TEST_P(AssemblyOf, TheWholeMatrixPassesThePatchTest) {
  const mesh::TetMesh mesh = test::shaken(uneven_box(GetParam()), 0.0005);
  const Eigen::Matrix3d gradient = Eigen::Matrix3d::Random();
  const Eigen::MatrixXd stiffness = full(fem::assemble(mesh, kSteel, test::element_of(mesh)).value().stiffness);
  Eigen::VectorXd exact(stiffness.rows());
  std::vector<int> inside, outside;
  for (int n = 0; n < mesh.nodes.rows(); ++n) {
    const Eigen::Vector3d at = mesh.nodes.row(n);
    exact.segment<3>(3 * n) = gradient * at;
    const bool inner = (at.array() > 0.002).all() && (at.array() < kSize.array() - 0.002).all();
    for (int i = 0; i < 3; ++i) (inner ? inside : outside).push_back(3 * n + i);
  }
  ASSERT_GT(inside.size(), 20u);
  const Eigen::MatrixXd coupling = stiffness(inside, outside), core = stiffness(inside, inside);
  const Eigen::VectorXd given = exact(outside);
  const Eigen::VectorXd found = dense::solve_symmetric(core, -coupling * given);
  EXPECT_LT((found - exact(inside)).norm(), 1e-10 * exact.norm());
}

// A displacement whose components are polynomials, and its gradient.
struct Polynomial {
  explicit Polynomial(int degree) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> number(-1, 1);
    for (int a = 0; a <= degree; ++a) {
      for (int b = 0; a + b <= degree; ++b) {
        for (int c = 0; a + b + c <= degree; ++c) {
          terms.push_back({{a, b, c}, {number(random), number(random), number(random)}});
        }
      }
    }
  }

  [[nodiscard]] Eigen::Vector3d at(const Eigen::Vector3d& x) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Term& term : terms) sum += term.factor * product(term.power, x);
    return sum;
  }
  [[nodiscard]] Eigen::Matrix3d gradient(const Eigen::Vector3d& x) const {  // du_i / dx_j
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Term& term : terms) {
      for (int j = 0; j < 3; ++j) {
        std::array<int, 3> power = term.power;
        if (power[j]-- > 0) sum.col(j) += term.factor * term.power[j] / kScale * product(power, x);
      }
    }
    return sum;
  }

 private:
  static constexpr double kScale = 0.1;
  struct Term {
    std::array<int, 3> power;
    Eigen::Vector3d factor;
  };
  static double product(const std::array<int, 3>& power, const Eigen::Vector3d& x) {
    double value = 1;
    for (int i = 0; i < 3; ++i) value *= std::pow(x[i] / kScale, power[i]);
    return value;
  }
  std::vector<Term> terms;
};

// Over the box, by the five-point Gauss rule along each axis: exact to degree 9 in each.
template <class Integrand>
double integral(const Integrand& integrand) {
  const std::array<double, 5> point = {-0.906179845938664, -0.538469310105683, 0, 0.538469310105683, 0.906179845938664};
  const std::array<double, 5> weight = {0.236926885056189, 0.478628670499366, 0.568888888888889, 0.478628670499366,
                                        0.236926885056189};
  double sum = 0;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) {
      for (int k = 0; k < 5; ++k) {
        const Eigen::Vector3d at(point[i], point[j], point[k]);
        sum += weight[i] * weight[j] * weight[k] / 8 * integrand((0.5 * (at.array() + 1) * kSize.array()).matrix());
      }
    }
  }
  return sum * kSize.prod();
}

TEST_P(AssemblyOf, APolynomialOfItsOrderHasExactlyItsEnergies) {
  const mesh::TetMesh mesh = uneven_box(GetParam());
  const fem::System system = fem::assemble(mesh, kSteel, test::element_of(mesh)).value();
  const Polynomial motion(GetParam());
  Eigen::VectorXd u(system.unknowns());
  for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n) u.segment<3>(3 * n) = motion.at(mesh.nodes.row(n));
  const double elastic = integral([&](const Eigen::Vector3d& x) {
    const Eigen::Matrix3d gradient = motion.gradient(x), strain = 0.5 * (gradient + gradient.transpose());
    return kSteel.lambda_pa() * std::pow(strain.trace(), 2) + 2 * kSteel.mu_pa() * strain.squaredNorm();
  });
  const double kinetic = 7850 * integral([&](const Eigen::Vector3d& x) { return motion.at(x).squaredNorm(); });
  EXPECT_NEAR(u.dot(system.stiffness.selfadjointView<Eigen::Lower>() * u), elastic, 1e-11 * elastic);
  EXPECT_NEAR(u.dot(fem::mass_times(system.node_mass, u).col(0)), kinetic, 1e-11 * kinetic);
}

TEST(Assembly, MassProductActsOnEachDirectionAlike) {
  const fem::System system = fem::assemble(curved_box(3), kSteel, fem::Element::kTet20).value();
  const Eigen::MatrixXd x = Eigen::MatrixXd::Random(system.unknowns(), 3);
  const Eigen::MatrixXd y = fem::mass_times(system.node_mass, x), mass = Eigen::MatrixXd(system.node_mass);
  for (int i = 0; i < 3; ++i) {
    const auto part = Eigen::seqN(i, system.node_mass.rows(), 3);
    const Eigen::MatrixXd along = x(part, Eigen::all), found = y(part, Eigen::all);
    EXPECT_LT((found - mass * along).norm(), 1e-13 * y.norm());
  }
}

TEST_P(AssemblyOf, TheWholeMatrixRepeatsBitForBitOnAnyNumberOfThreads) {
  const mesh::TetMesh mesh = test::bent(mesh::to_order(test::box_mesh({5, 4, 3}, kSize), GetParam()), 5);
  const fem::System one = fem::assemble(mesh, kSteel, test::element_of(mesh), 1).value();
  for (const int threads : {1, 2, 3, 0}) {
    const fem::System other = fem::assemble(mesh, kSteel, test::element_of(mesh), threads).value();
    EXPECT_TRUE((one.stiffness.coeffs() == other.stiffness.coeffs()).all()) << threads;
    EXPECT_TRUE((one.node_mass.coeffs() == other.node_mass.coeffs()).all()) << threads;
  }
}

TEST(Assembly, ElementsAreKnownByTheirNames) {
  using fem::Element;
  for (const Element element :
       {Element::kTet4, Element::kTet4Lumped, Element::kTet10, Element::kTet20, Element::kTet35}) {
    EXPECT_EQ(fem::parse_element(fem::element_name(element)).value(), element);
  }
  EXPECT_EQ(fem::order_of(fem::parse_element("tet20").value()), 3);
  EXPECT_FALSE(fem::parse_element("hex8"));
}

TEST(Assembly, AssemblyRefusesMaterialsThatAreNotStable) {
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
  const Eigen::VectorXd right = dense::generalized_spectrum(full(system.stiffness), mass)->values;
  const Eigen::VectorXd reports = dense::generalized_spectrum(report, mass)->values;
  for (Eigen::Index m = 6; m < right.size(); ++m) {
    EXPECT_NEAR(12 * std::log2(std::sqrt(right[m] / reports[m])), 6, 1e-6) << m;
  }
}

}  // namespace
}  // namespace ringdown::assembly_test
