#include "engine/fem/element.h"

#include "tests/fem/sample_meshes.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <numeric>

namespace ringdown::element_test {
namespace {

constexpr fem::Elastic kSteel{200e9, 0.3, 7850};

using mesh::ElementNodes;
using Stiffness4 = Eigen::Matrix<double, 12, 12>;

mesh::Corners random_corners(std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(0, 0.1);
  for (;;) {
    mesh::Corners corners = mesh::Corners::NullaryExpr([&] { return coordinate(random); });
    const double determinant = mesh::jacobian(corners).determinant();
    if (std::abs(determinant) < 1e-5) continue;
    if (determinant < 0) corners.row(1).swap(corners.row(2));
    return corners;
  }
}

ElementNodes straight(int order, const mesh::Corners& corners) { return mesh::reference_nodes(order) * corners; }

// The nodes moved by a wave longer than the element, which leaves no edge straight.
ElementNodes curved(int order, const mesh::Corners& corners, std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  const Eigen::Matrix3d wave_number = 15 * Eigen::Matrix3d::NullaryExpr([&] { return number(random); });
  ElementNodes nodes = straight(order, corners);
  for (int a = 0; a < nodes.rows(); ++a) {
    nodes.row(a) += 0.006 * (nodes.row(a) * wave_number).array().sin().matrix();
  }
  return nodes;
}

// Gradients of the linear shape functions: rows 1..3 of the inverse of [1; x] for the four corners.
Eigen::Matrix<double, 3, 4> linear_gradients(const mesh::Corners& corners) {
  Eigen::Matrix4d positions;
  positions << Eigen::RowVector4d::Ones(), corners.transpose();
  return positions.inverse().rightCols<3>().transpose();
}

double volume(const mesh::Corners& corners) {
  const Eigen::Vector3d a = corners.row(1) - corners.row(0), b = corners.row(2) - corners.row(0),
                        c = corners.row(3) - corners.row(0);
  return a.cross(b).dot(c) / 6;
}

// vol B^T D B with the 6 x 12 strain matrix and Hooke's 6 x 6 law in engineering shear strains.
Stiffness4 textbook_stiffness(const mesh::Corners& corners, const fem::Elastic& elastic) {
  const Eigen::Matrix<double, 3, 4> g = linear_gradients(corners);
  Eigen::Matrix<double, 6, 12> b = Eigen::Matrix<double, 6, 12>::Zero();
  for (int a = 0; a < 4; ++a) {
    b.block<6, 3>(0, 3 * a) << g(0, a), 0, 0, 0, g(1, a), 0, 0, 0, g(2, a), g(1, a), g(0, a), 0, 0, g(2, a), g(1, a),
        g(2, a), 0, g(0, a);
  }
  const double nu = elastic.poisson_ratio, factor = elastic.youngs_modulus_pa / ((1 + nu) * (1 - 2 * nu));
  Eigen::Matrix<double, 6, 6> d = Eigen::Matrix<double, 6, 6>::Zero();
  d.topLeftCorner<3, 3>().setConstant(nu);
  d.diagonal() << 1 - nu, 1 - nu, 1 - nu, (1 - 2 * nu) / 2, (1 - 2 * nu) / 2, (1 - 2 * nu) / 2;
  return volume(corners) * b.transpose() * (factor * d) * b;
}

void expect_rigid_motion_is_free(const ElementNodes& nodes) {
  const Eigen::MatrixXd stiffness = fem::stiffness(nodes, kSteel);
  for (int motion = 0; motion < 6; ++motion) {
    Eigen::VectorXd displacement(stiffness.rows());
    for (int a = 0; a < nodes.rows(); ++a) {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(motion % 3), at = nodes.row(a) / 0.1;
      displacement.segment<3>(3 * a) = motion < 3 ? axis : axis.cross(at);
    }
    EXPECT_LT((stiffness * displacement).norm(), 1e-12 * stiffness.norm() * displacement.norm()) << motion;
  }
}

TEST(LinearElement, TheStiffnessOfALinearElementIsTheTextbooksOverTwoHundredRandomTetrahedra) {
  std::mt19937 random(11);
  double worst = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const mesh::Corners corners = random_corners(random);
    const Stiffness4 exact = textbook_stiffness(corners, kSteel);
    worst = std::max(worst, (fem::stiffness(corners, kSteel) - exact).norm() / exact.norm());
  }
  EXPECT_LT(worst, 1e-12);
}

TEST(LinearElement, TheMassOfALinearElementIsTheVolumesTwentiethAndItsLumpsAQuarter) {
  std::mt19937 random(12);
  const mesh::Corners corners = random_corners(random);
  const double mass = 7850 * volume(corners);
  const Eigen::Matrix4d consistent = fem::consistent_mass(corners, 7850), lumped = fem::lumped_mass(corners, 7850);
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b) {
      EXPECT_NEAR(consistent(a, b), mass / 20 * (a == b ? 2 : 1), 1e-14 * mass);
      EXPECT_NEAR(lumped(a, b), a == b ? mass / 4 : 0, 1e-14 * mass);
    }
  }
}

class Elements : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Orders, Elements, testing::Range(1, mesh::kMaxOrder + 1));

class CurvedElements : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Orders, CurvedElements, testing::Range(2, mesh::kMaxOrder + 1));

TEST_P(Elements, RigidMotionCostsNoEnergy) {
  std::mt19937 random(13);
  for (int trial = 0; trial < 10; ++trial) {
    const mesh::Corners corners = random_corners(random);
    expect_rigid_motion_is_free(straight(GetParam(), corners));
    expect_rigid_motion_is_free(curved(GetParam(), corners, random));
  }
}

TEST_P(Elements, ElementsAgreeWithTheLinearOneWhereDisplacementIsLinear) {
  std::mt19937 random(14);
  const mesh::Corners corners = random_corners(random);
  const Eigen::Matrix<double, 4, 3> moved = Eigen::Matrix<double, 4, 3>::Random();
  const Eigen::VectorXd at_corners = moved.reshaped<Eigen::RowMajor>();
  const Eigen::VectorXd at_nodes = (mesh::reference_nodes(GetParam()) * moved).reshaped<Eigen::RowMajor>();
  const double linear = at_corners.dot(textbook_stiffness(corners, kSteel) * at_corners);
  const Eigen::MatrixXd stiffness = fem::stiffness(straight(GetParam(), corners), kSteel);
  EXPECT_NEAR(at_nodes.dot(stiffness * at_nodes), linear, 1e-12 * linear);
}

// The matrix found in tables, for straight edges: volume/420 times these numbers.
TEST(QuadraticElement, MassOfAQuadraticElementIsTheTabulatedOne) {
  std::mt19937 random(15);
  const mesh::Corners corners = random_corners(random);
  const Eigen::MatrixXd mass = fem::consistent_mass(straight(2, corners), 420 / volume(corners));
  const auto on_edge = [](int corner, int edge) {
    return mesh::kTetEdges[edge][0] == corner || mesh::kTetEdges[edge][1] == corner;
  };
  for (int a = 0; a < 10; ++a) {
    for (int b = 0; b < 10; ++b) {
      double expected = 0;
      if (a < 4 && b < 4) expected = a == b ? 6 : 1;
      if ((a < 4) != (b < 4)) expected = on_edge(std::min(a, b), std::max(a, b) - 4) ? -4 : -6;
      if (a >= 4 && b >= 4) {
        const auto [i, j] = mesh::kTetEdges[a - 4];
        expected = a == b ? 32 : (on_edge(i, b - 4) || on_edge(j, b - 4)) ? 16 : 8;
      }
      EXPECT_NEAR(mass(a, b), expected, 1e-11) << a << " " << b;
    }
  }
}

// Volume of a curved element by cutting the reference tetrahedron into small straight ones.
double volume_by_cutting(const ElementNodes& nodes, int parts) {
  const mesh::TetMesh cube = test::box_mesh({parts, parts, parts}, {1, 1, 1});
  Eigen::MatrixX3d mapped(cube.nodes.rows(), 3);
  for (Eigen::Index n = 0; n < cube.nodes.rows(); ++n) {  // the unit cube squeezed onto the tetrahedron
    const Eigen::Vector3d p = cube.nodes.row(n);
    const double l1 = p[0], l2 = (1 - p[0]) * p[1], l3 = (1 - p[0]) * (1 - p[1]) * p[2];
    const Eigen::Vector4d at(1 - l1 - l2 - l3, l1, l2, l3);
    mapped.row(n) = mesh::interpolation(mesh::order_of_nodes(nodes.rows()), at).transpose() * nodes;
  }
  double sum = 0;
  for (Eigen::Index e = 0; e < cube.elements.rows(); ++e) {
    mesh::Corners corners;
    for (int a = 0; a < 4; ++a) corners.row(a) = mapped.row(cube.elements(e, a));
    sum += volume(corners);
  }
  return sum;
}

TEST_P(CurvedElements, MassSumsToTheCurvedVolume) {
  std::mt19937 random(16);
  const ElementNodes nodes = curved(GetParam(), random_corners(random), random);
  const double coarse = volume_by_cutting(nodes, 12), fine = volume_by_cutting(nodes, 24);
  const double exact = fine + (fine - coarse) / 3;  // Richardson, the error falls with the square
  EXPECT_GT(std::abs(exact / volume(nodes.topRows<4>()) - 1), 1e-3) << "the element is not curved enough to tell";
  EXPECT_NEAR(fem::consistent_mass(nodes, 1).sum(), exact, 1e-5 * exact);
}

// Nearly straight elements take the other way through the code: the two must meet.
TEST_P(CurvedElements, CurvedElementsBecomeTheStraightOnesAsTheyStraighten) {
  std::mt19937 random(18);
  const mesh::Corners corners = random_corners(random);
  const ElementNodes flat = straight(GetParam(), corners);
  ElementNodes nearly = flat;
  nearly.row(5) += 1e-7 * (corners.row(1) - corners.row(0));
  ASSERT_FALSE(mesh::is_straight(nearly));
  const Eigen::MatrixXd stiffness = fem::stiffness(flat, kSteel), mass = fem::consistent_mass(flat, 7850);
  EXPECT_LT((fem::stiffness(nearly, kSteel) - stiffness).norm(), 1e-5 * stiffness.norm());
  EXPECT_LT((fem::consistent_mass(nearly, 7850) - mass).norm(), 1e-5 * mass.norm());
}

TEST_P(CurvedElements, EvenlyStretchedCurvedElementsHoldTheEnergyOfTheirVolume) {
  std::mt19937 random(17);
  const ElementNodes nodes = curved(GetParam(), random_corners(random), random);
  const Eigen::Matrix3d gradient = Eigen::Matrix3d::Random();
  const Eigen::VectorXd displacement = (nodes * gradient.transpose()).reshaped<Eigen::RowMajor>();
  const Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose());
  const double density = kSteel.lambda_pa() * std::pow(strain.trace(), 2) + 2 * kSteel.mu_pa() * strain.squaredNorm();
  const double expected = density * fem::consistent_mass(nodes, 1).sum();
  EXPECT_NEAR(displacement.dot(fem::stiffness(nodes, kSteel) * displacement), expected, 1e-11 * expected);
}

// l1^a l2^b l3^c has the mean 6 a! b! c! / (a + b + c + 3)! over a tetrahedron.
TEST(Quadrature, ARuleIsExactUpToItsDegree) {
  for (const int degree : {1, 2, 3, 4, 5, 7, 9, 12, 17}) {
    for (int a = 0; a <= degree; ++a) {
      for (int b = 0; a + b <= degree; ++b) {
        const int c = degree - a - b;
        double sum = 0;
        for (const mesh::QuadraturePoint& point : mesh::tet_quadrature(degree)) {
          const Eigen::Vector4d& l = point.barycentric;
          sum += point.weight * std::pow(l[1], a) * std::pow(l[2], b) * std::pow(l[3], c);
        }
        const double exact = 6 * std::tgamma(a + 1) * std::tgamma(b + 1) * std::tgamma(c + 1) / std::tgamma(degree + 4);
        EXPECT_NEAR(sum, exact, 1e-13 * exact + 1e-15) << degree << ": " << a << " " << b << " " << c;
      }
    }
  }
}

}  // namespace
}  // namespace ringdown::element_test
