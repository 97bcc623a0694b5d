#include "engine/mesh/tet_element.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace ringdown::tet_basis_test {
namespace {

Eigen::Vector4d random_point(std::mt19937& random) {
  std::exponential_distribution<double> part;
  Eigen::Vector4d l(part(random), part(random), part(random), part(random));
  return l / l.sum();
}

// A polynomial of full degree, nothing like a product of Lagrange's.
double wave(int degree, const Eigen::Vector4d& l) {
  return std::pow(0.3 + l[1] - 0.7 * l[2] + 0.4 * l[3], degree) - l[2] * std::pow(l[3] + 0.2, degree - 1);
}

class TetBasis : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Orders, TetBasis, testing::Range(1, mesh::kMaxOrder + 1));

TEST_P(TetBasis, EachWeightIsOneAtItsNodeAndZeroAtTheOthers) {
  const mesh::Barycentric nodes = mesh::reference_nodes(GetParam());
  ASSERT_EQ(nodes.rows(), mesh::nodes_per_element(GetParam()));
  for (Eigen::Index a = 0; a < nodes.rows(); ++a) {
    EXPECT_NEAR(nodes.row(a).sum(), 1, 1e-15);
    const Eigen::VectorXd values = mesh::interpolation(GetParam(), nodes.row(a).transpose());
    EXPECT_LT((values - Eigen::VectorXd::Unit(nodes.rows(), a)).norm(), 1e-13) << a;
  }
}

TEST_P(TetBasis, TheWeightsSumToOneAndInterpolatePolynomialsOfTheirOrder) {
  std::mt19937 random(1);
  const mesh::Barycentric nodes = mesh::reference_nodes(GetParam());
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Vector4d at = random_point(random);
    const Eigen::VectorXd values = mesh::interpolation(GetParam(), at);
    double found = 0;
    for (Eigen::Index a = 0; a < nodes.rows(); ++a) {
      found += values[a] * wave(GetParam(), nodes.row(a).transpose());
    }
    EXPECT_NEAR(values.sum(), 1, 1e-13);
    EXPECT_NEAR(found, wave(GetParam(), at), 1e-13);
  }
}

TEST_P(TetBasis, TheGradientIsThatOfTheWeights) {
  std::mt19937 random(2);
  const double step = 1e-5;
  for (int trial = 0; trial < 10; ++trial) {
    const Eigen::Vector4d at = random_point(random);
    const mesh::ReferenceGradient gradient = mesh::interpolation_gradient(GetParam(), at);
    EXPECT_LT(gradient.colwise().sum().norm(), 1e-12);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector4d move = step * (Eigen::Vector4d::Unit(i + 1) - Eigen::Vector4d::Unit(0));
      const Eigen::VectorXd slope =
          (mesh::interpolation(GetParam(), at + move) - mesh::interpolation(GetParam(), at - move)) / (2 * step);
      EXPECT_LT((gradient.col(i) - slope).norm(), 1e-7);
    }
  }
}

// Corners, then edges, then faces, then the inside: as many coordinates are not zero.
TEST_P(TetBasis, NodesOfAnElementAreOrderedByDimension) {
  const int order = GetParam();
  const mesh::Barycentric nodes = mesh::reference_nodes(order);
  Eigen::Index at = 0;
  const auto expect = [&](int count, auto&& corners) {
    for (int k = 0; k < count; ++k, ++at) {
      for (int i = 0; i < 4; ++i) {
        const bool on = std::find(corners.begin(), corners.end(), i) != corners.end();
        EXPECT_EQ(nodes(at, i) > 0, on) << at;
      }
    }
  };
  for (int i = 0; i < 4; ++i) expect(1, std::array{i});
  for (const auto& edge : mesh::kTetEdges) expect(mesh::nodes_per_edge(order), edge);
  for (const auto& face : mesh::kTetFaces) expect(mesh::nodes_per_face(order), face);
  expect(mesh::nodes_inside(order), std::array{0, 1, 2, 3});
  EXPECT_EQ(at, nodes.rows());
}

TEST(TetBasisOrder, TheOrderIsKnownByTheNumberOfNodes) {
  EXPECT_EQ(mesh::order_of_nodes(4), 1);
  EXPECT_EQ(mesh::order_of_nodes(10), 2);
  EXPECT_EQ(mesh::order_of_nodes(20), 3);
  EXPECT_EQ(mesh::order_of_nodes(35), 4);
  EXPECT_EQ(mesh::order_of_nodes(8), 0);
}

}  // namespace
}  // namespace ringdown::tet_basis_test
