// Functions of one degree more than a mesh's own.
#include "engine/fem/surplus.h"

#include "engine/dense/decompositions.h"
#include "tests/fem/sample_meshes.h"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <map>

namespace ringdown::surplus_test {
namespace {

TEST(SurplusBasis, TheSurplusSpansWithTheShapeFunctionsWhatOneDegreeMoreSpans) {
  for (int order = 1; order <= mesh::kMaxOrder; ++order) {
    const int all = mesh::nodes_per_element(order) + fem::surplus_per_element(order);
    EXPECT_EQ(all, (order + 2) * (order + 3) * (order + 4) / 6);
    const auto rule = mesh::tet_quadrature(2 * order + 2);  // exact for products: a Gram matrix
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(all, all);
    for (const auto& point : rule) {
      Eigen::VectorXd values(all);
      values << mesh::interpolation(order, point.barycentric), fem::surplus_shape(order, point.barycentric);
      gram += point.weight * values * values.transpose();
    }
    const Eigen::VectorXd scale = gram.diagonal().cwiseSqrt().cwiseInverse();
    EXPECT_GT(dense::eigenvalues(scale.asDiagonal() * gram * scale.asDiagonal())[0], 1e-9) << order;
  }
}

TEST(SurplusBasis, GradientsAreDifferencesOfValues) {
  const Eigen::Vector4d at(0.1, 0.25, 0.3, 0.35);
  for (int order = 1; order <= mesh::kMaxOrder; ++order) {
    const mesh::ReferenceGradient gradient = fem::surplus_gradient(order, at);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector4d step = 1e-6 * (Eigen::Vector4d::Unit(i + 1) - Eigen::Vector4d::Unit(0));
      const Eigen::VectorXd slope =
          (fem::surplus_shape(order, at + step) - fem::surplus_shape(order, at - step)) / 2e-6;
      EXPECT_LT((slope - gradient.col(i)).norm(), 1e-8) << order;
    }
  }
}

TEST(SurplusBasis, TheSurplusIsNothingOnEdgesAndFacesOfOthers) {
  for (int order = 1; order <= mesh::kMaxOrder; ++order) {
    const Eigen::VectorXd on_edge = fem::surplus_shape(order, {0.2, 0, 0.8, 0});  // the edge of corners 0 and 2
    const Eigen::VectorXd on_face = fem::surplus_shape(order, {0, 0.3, 0.2, 0.5});
    for (Eigen::Index k = 0; k < on_edge.size(); ++k) EXPECT_EQ(on_edge[k] != 0, k == 1) << order;
    const int face = 6 + 3 * fem::surplus_per_face(order), inside = face + fem::surplus_per_face(order);
    for (Eigen::Index k = 0; k < on_face.size(); ++k) {
      const bool own = k == 3 || k == 4 || k == 5 || (k >= face && k < inside);
      EXPECT_TRUE(own || on_face[k] == 0) << order << " " << k;
    }
  }
}

// The values of all functions of the mesh at a point of element e.
std::map<int, double> values_at(const fem::SurplusSpace& space, int order, Eigen::Index e, const Eigen::Vector4d& at) {
  const Eigen::VectorXd values = fem::surplus_shape(order, at);
  std::map<int, double> by_number;
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    if (values[k] != 0) by_number[space.functions(e, k)] = values[k];
  }
  return by_number;
}

TEST(SurplusSpace, NeighboursAgreeOnTheFaceBetweenThem) {
  for (int order = 1; order <= mesh::kMaxOrder; ++order) {
    const mesh::TetMesh box = mesh::to_order(test::box_mesh({2, 2, 2}, {1, 1, 1}), order);
    const fem::SurplusSpace space = fem::surplus_space(box);
    std::map<std::array<int, 3>, std::map<int, double>> seen;
    int shared = 0;
    for (Eigen::Index e = 0; e < box.elements.rows(); ++e) {
      for (const auto& face : fem::kRisingFaces) {
        Eigen::Vector4d at = Eigen::Vector4d::Zero();
        std::array<int, 3> key{};
        for (int i = 0; i < 3; ++i) {
          at[face[i]] = std::array{0.2, 0.3, 0.5}[i];
          key[i] = space.nodes(e, face[i]);
        }
        const auto [found, is_new] = seen.try_emplace(key, values_at(space, order, e, at));
        if (is_new) continue;
        ++shared;
        EXPECT_EQ(found->second, values_at(space, order, e, at));
      }
    }
    EXPECT_EQ(shared, 4 * 48 / 2 - 24);  // 48 elements; 48 of the faces lie on the surface
  }
}

}  // namespace
}  // namespace ringdown::surplus_test
