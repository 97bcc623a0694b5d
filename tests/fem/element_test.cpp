#include "engine/fem/element.h"

#include "tests/fem/sample_meshes.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace ringdown {
namespace {

constexpr fem::Elastic kSteel{200e9, 0.3, 7850};

mesh::Corners random_corners(std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(0, 0.1);
  for (;;) {
    mesh::Corners corners = mesh::Corners::NullaryExpr([&] { return coordinate(random); });
    const double determinant = mesh::jacobian4(corners).determinant();
    if (std::abs(determinant) < 1e-5) continue;
    if (determinant < 0) corners.row(1).swap(corners.row(2));
    return corners;
  }
}

mesh::Nodes10 straight(const mesh::Corners& corners) {
  mesh::Nodes10 nodes;
  nodes.topRows<4>() = corners;
  for (int e = 0; e < 6; ++e) {
    nodes.row(4 + e) = 0.5 * (corners.row(mesh::kTetEdges[e][0]) + corners.row(mesh::kTetEdges[e][1]));
  }
  return nodes;
}

mesh::Nodes10 curved(const mesh::Corners& corners, std::mt19937& random) {
  std::uniform_real_distribution<double> shift(-0.002, 0.002);
  mesh::Nodes10 nodes = straight(corners);
  for (int e = 4; e < 10; ++e) {
    for (int i = 0; i < 3; ++i) nodes(e, i) += shift(random);
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
fem::Stiffness4 textbook_stiffness(const mesh::Corners& corners, const fem::Elastic& elastic) {
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

template <class Matrix, class Nodes>
void expect_rigid_motion_is_free(const Matrix& stiffness, const Nodes& nodes) {
  for (int motion = 0; motion < 6; ++motion) {
    Eigen::VectorXd displacement(stiffness.rows());
    for (int a = 0; a < nodes.rows(); ++a) {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(motion % 3), at = nodes.row(a) / 0.1;
      displacement.segment<3>(3 * a) = motion < 3 ? axis : axis.cross(at);
    }
    EXPECT_LT((stiffness * displacement).norm(), 1e-12 * stiffness.norm() * displacement.norm()) << motion;
  }
}

TEST(LinearElement, StiffnessIsTheTextbooksOverTwoHundredRandomTetrahedra) {
  std::mt19937 random(11);
  double worst = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const mesh::Corners corners = random_corners(random);
    const fem::Stiffness4 exact = textbook_stiffness(corners, kSteel);
    worst = std::max(worst, (fem::stiffness4(corners, kSteel) - exact).norm() / exact.norm());
  }
  EXPECT_LT(worst, 1e-12);
}

TEST(LinearElement, MassIsTheVolumesTwentiethAndItsLumpsAQuarter) {
  std::mt19937 random(12);
  const mesh::Corners corners = random_corners(random);
  const double mass = 7850 * volume(corners);
  const fem::Mass4 consistent = fem::consistent_mass4(corners, 7850), lumped = fem::lumped_mass4(corners, 7850);
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b) {
      EXPECT_NEAR(consistent(a, b), mass / 20 * (a == b ? 2 : 1), 1e-14 * mass);
      EXPECT_NEAR(lumped(a, b), a == b ? mass / 4 : 0, 1e-14 * mass);
    }
  }
}

TEST(Elements, RigidMotionCostsNoEnergy) {
  std::mt19937 random(13);
  for (int trial = 0; trial < 20; ++trial) {
    const mesh::Corners corners = random_corners(random);
    expect_rigid_motion_is_free(fem::stiffness4(corners, kSteel), corners);
    const mesh::Nodes10 flat = straight(corners), bowed = curved(corners, random);
    expect_rigid_motion_is_free(fem::stiffness10(flat, kSteel), flat);
    expect_rigid_motion_is_free(fem::stiffness10(bowed, kSteel), bowed);
  }
}

TEST(QuadraticElement, AgreesWithTheLinearOneWhereDisplacementIsLinear) {
  std::mt19937 random(14);
  const mesh::Corners corners = random_corners(random);
  const Eigen::VectorXd moved = Eigen::VectorXd::Random(12);
  Eigen::VectorXd moved10(30);
  moved10.head<12>() = moved;
  for (int e = 0; e < 6; ++e) {
    const auto [i, j] = mesh::kTetEdges[e];
    moved10.segment<3>(12 + 3 * e) = 0.5 * (moved.segment<3>(3 * i) + moved.segment<3>(3 * j));
  }
  const double linear = moved.dot(textbook_stiffness(corners, kSteel) * moved);
  EXPECT_NEAR(moved10.dot(fem::stiffness10(straight(corners), kSteel) * moved10), linear, 1e-12 * linear);
}

// The matrix found in tables, for straight edges: volume/420 times these numbers.
TEST(QuadraticElement, MassIsTheTabulatedOne) {
  std::mt19937 random(15);
  const mesh::Corners corners = random_corners(random);
  const fem::Mass10 mass = fem::consistent_mass10(straight(corners), 420 / volume(corners));
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
double volume_by_cutting(const mesh::Nodes10& nodes, int parts) {
  const mesh::TetMesh cube = test::box_mesh({parts, parts, parts}, {1, 1, 1});
  double sum = 0;
  for (Eigen::Index e = 0; e < cube.elements.rows(); ++e) {
    mesh::Corners mapped;
    for (int a = 0; a < 4; ++a) {  // the unit cube squeezed onto the tetrahedron: x, (1-x) y, (1-x)(1-y) z
      const Eigen::Vector3d p = cube.nodes.row(cube.elements(e, a));
      const double l1 = p[0], l2 = (1 - p[0]) * p[1], l3 = (1 - p[0]) * (1 - p[1]) * p[2];
      mapped.row(a) = mesh::shape10({1 - l1 - l2 - l3, l1, l2, l3}).transpose() * nodes;
    }
    sum += volume(mapped);
  }
  return sum;
}

TEST(QuadraticElement, CurvedMassSumsToTheCurvedVolume) {
  std::mt19937 random(16);
  const mesh::Nodes10 nodes = curved(random_corners(random), random);
  const double coarse = volume_by_cutting(nodes, 20), fine = volume_by_cutting(nodes, 40);
  const double exact = fine + (fine - coarse) / 3;  // Richardson, the error falls with the square
  EXPECT_GT(std::abs(exact / volume(nodes.topRows<4>()) - 1), 1e-3) << "the element is not curved enough to tell";
  EXPECT_NEAR(fem::consistent_mass10(nodes, 1).sum(), exact, 1e-6 * exact);
}

TEST(QuadraticElement, CurvedElementStretchedEvenlyHoldsTheEnergyOfItsVolume) {
  std::mt19937 random(17);
  const mesh::Nodes10 nodes = curved(random_corners(random), random);
  const Eigen::Matrix3d gradient = Eigen::Matrix3d::Random();
  Eigen::VectorXd displacement(30);
  for (int a = 0; a < 10; ++a) displacement.segment<3>(3 * a) = gradient * nodes.row(a).transpose();
  const Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose());
  const double density = kSteel.lambda_pa() * std::pow(strain.trace(), 2) + 2 * kSteel.mu_pa() * strain.squaredNorm();
  const double expected = density * fem::consistent_mass10(nodes, 1).sum();
  EXPECT_NEAR(displacement.dot(fem::stiffness10(nodes, kSteel) * displacement), expected, 1e-11 * expected);
}

// l1^a l2^b l3^c has the mean 6 a! b! c! / (a + b + c + 3)! over a tetrahedron.
TEST(Quadrature, IsExactUpToItsDegree) {
  for (const int degree : {1, 2, 3, 4, 5, 7, 9}) {
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
}  // namespace ringdown
