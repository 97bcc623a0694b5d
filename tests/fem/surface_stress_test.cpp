// Stress on the skin, against closed forms.
#include "engine/fem/surface_stress.h"

#include "engine/dense/decompositions.h"
#include "engine/mesh/boundary.h"
#include "tests/fem/sample_meshes.h"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace ringdown::fem {
namespace {

constexpr Elastic kGlass{72e9, 0.23, 2530};
const Eigen::Vector3d kBoxSize(0.1, 0.08, 0.06);

using Field = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

// A displacement at all nodes, as one column.
Eigen::MatrixXd sampled(const mesh::TetMesh& mesh, const Field& field) {
  Eigen::MatrixXd shape(3 * mesh.nodes.rows(), 1);
  for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n)
    shape.block<3, 1>(3 * n, 0) = field(mesh.nodes.row(n).transpose());
  return shape;
}

// The stress tensor at point p in the frame of the mesh, of field `column`.
Eigen::Matrix3d tensor_at(const SurfaceStress& stress, Eigen::Index p, Eigen::Index column = 0) {
  const Eigen::Vector3d first = stress.first.row(p), second = stress.second.row(p);
  const Eigen::Vector3d s = stress.components.col(column).segment<3>(3 * p);
  return s[0] * first * first.transpose() + s[1] * second * second.transpose() +
         s[2] * (first * second.transpose() + second * first.transpose());
}

std::vector<mesh::TetMesh> meshes_of(int order) {
  const mesh::TetMesh box = mesh::to_order(test::box_mesh({3, 2, 2}, kBoxSize), order);
  return {box, test::bent(box, 5), test::shaken(box, 5e-4)};
}

class SurfaceStressOf : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Orders, SurfaceStressOf, testing::Range(1, mesh::kMaxOrder + 1));

TEST_P(SurfaceStressOf, RigidMotionHasNone) {
  for (const mesh::TetMesh& mesh : meshes_of(GetParam())) {
    const Eigen::Vector3d axis(0.3, -1, 0.7), shift(2, 1, -1);
    const Eigen::MatrixXd moved = sampled(mesh, [&](const auto& x) { return Eigen::Vector3d(axis.cross(x) + shift); });
    const SurfaceStress stress = surface_stress(mesh, kGlass, moved);
    EXPECT_LT(stress.components.cwiseAbs().maxCoeff(), 1e-11 * kGlass.youngs_modulus_pa);
    EXPECT_LT(stress.largest[0], 1e-11 * kGlass.youngs_modulus_pa);
  }
}

// Stretch along x, with the sides that Poisson's ratio draws in: on any skin the stress is E e along the part of x that
// lies in the skin, once forces on the skin keep it so; on skins along x, E e exactly.
TEST_P(SurfaceStressOf, PureStretchIsYoungsModulusTimesStrain) {
  const mesh::TetMesh box = mesh::to_order(test::box_mesh({3, 2, 2}, kBoxSize), GetParam());
  const double e = 1e-3, nu = kGlass.poisson_ratio;
  const SurfaceStress stress = surface_stress(box, kGlass, sampled(box, [&](const auto& x) {
                                                return Eigen::Vector3d(e * x[0], -nu * e * x[1], -nu * e * x[2]);
                                              }));
  const Eigen::Matrix3d truth = Eigen::Vector3d(72e6, 0, 0).asDiagonal();
  int seen = 0;
  for (Eigen::Index p = 0; p < stress.positions.rows(); ++p) {
    if (std::abs(stress.normals(p, 0)) > 0.5) continue;
    EXPECT_LT((tensor_at(stress, p) - truth).norm(), 1e-9 * 72e6);
    ++seen;
  }
  EXPECT_GT(seen, 30);
}

// A field of constant strain in curved and irregular elements: on a skin with the normal n the strain within the skin
// is known, and the plane law acts on it.
TEST_P(SurfaceStressOf, CurvedSkinsTakeTheStrainWithinTheSkin) {
  Eigen::Matrix3d gradient;
  gradient << 1, 2, -1, 0.5, -2, 0.3, 0.1, -0.7, 1.5;
  const Eigen::Matrix3d strain = (gradient + gradient.transpose()) / 2;
  for (const mesh::TetMesh& mesh : meshes_of(GetParam())) {
    const SurfaceStress stress =
        surface_stress(mesh, kGlass, sampled(mesh, [&](const auto& x) { return Eigen::Vector3d(gradient * x); }));
    for (Eigen::Index p = 0; p < stress.positions.rows(); ++p) {
      const Eigen::Vector3d normal = stress.normals.row(p);
      // Plane stress: the normal strain that frees the normal of stress, by Hooke's law in three dimensions.
      const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - normal * normal.transpose();
      const Eigen::Matrix3d within = across * strain * across;
      const double nu = kGlass.poisson_ratio, thinner = -nu / (1 - nu) * within.trace();
      const Eigen::Matrix3d all = within + thinner * normal * normal.transpose();
      const Eigen::Matrix3d truth =
          kGlass.lambda_pa() * all.trace() * Eigen::Matrix3d::Identity() + 2 * kGlass.mu_pa() * all;
      EXPECT_LT((truth * normal).norm(), 1e-12 * truth.norm());
      EXPECT_LT((tensor_at(stress, p) - truth).norm(), 1e-9 * truth.norm());
    }
  }
}

// A bar bent to the curvature kappa: u = (kappa x z, -nu kappa y z, -kappa (x^2 + nu (z^2 - y^2)) / 2), the exact
// solution of Saint-Venant; on top and bottom the stress is E kappa h / 2 (Timoshenko & Goodier, section 102).
TEST(SurfaceStress, ABentBarHasTheStressOfItsCurvature) {
  const double length = 0.2, width = 0.02, height = 0.01, kappa = 0.1, nu = kGlass.poisson_ratio;
  for (int order = 2; order <= mesh::kMaxOrder; ++order) {
    const mesh::TetMesh bar = mesh::to_order(test::box_mesh({8, 2, 1}, {length, width, height}), order);
    const SurfaceStress stress = surface_stress(bar, kGlass, sampled(bar, [&](const Eigen::Vector3d& at) {
                                                  const double x = at[0], y = at[1] - width / 2, z = at[2] - height / 2;
                                                  return Eigen::Vector3d(kappa * x * z, -nu * kappa * y * z,
                                                                         -kappa * (x * x + nu * (z * z - y * y)) / 2);
                                                }));
    const double truth = kGlass.youngs_modulus_pa * kappa * height / 2;
    EXPECT_NEAR(stress.largest[0], truth, 1e-9 * truth);
    for (Eigen::Index p = 0; p < stress.positions.rows(); ++p) {
      if (std::abs(stress.normals(p, 0)) > 0.5) continue;  // the ends are not free
      const double sign = (stress.positions(p, 2) - height / 2) / (height / 2);
      EXPECT_NEAR(tensor_at(stress, p)(0, 0), sign * truth, 1e-9 * truth);
    }
  }
}

// A plate bent equally in both directions: E kappa h / (2 (1 - nu)) on both faces, in all directions.
TEST(SurfaceStress, APlateBentToASphereHasItsStress) {
  const double side = 0.2, height = 0.004, kappa = 0.2, nu = kGlass.poisson_ratio;
  const mesh::TetMesh plate = mesh::to_order(test::box_mesh({6, 6, 1}, {side, side, height}), 2);
  const SurfaceStress stress = surface_stress(
      plate, kGlass, sampled(plate, [&](const Eigen::Vector3d& at) {
        const double x = at[0] - side / 2, y = at[1] - side / 2, z = at[2] - height / 2;
        return Eigen::Vector3d(kappa * x * z, kappa * y * z, -kappa * ((x * x + y * y) / 2 + nu / (1 - nu) * z * z));
      }));
  const double truth = kGlass.youngs_modulus_pa * kappa * height / 2 / (1 - nu);
  for (Eigen::Index p = 0; p < stress.positions.rows(); ++p) {
    if (std::abs(stress.normals(p, 2)) < 0.5) continue;
    const double sign = stress.normals(p, 2) > 0 ? 1 : -1;
    const auto [larger, smaller] =
        principal_stress(stress.components(3 * p, 0), stress.components(3 * p + 1, 0), stress.components(3 * p + 2, 0));
    EXPECT_NEAR(larger, sign * truth, 1e-9 * truth);
    EXPECT_NEAR(smaller, sign * truth, 1e-9 * truth);
  }
  EXPECT_NEAR(stress.largest[0], truth, 1e-9 * truth);
}

TEST(SurfaceStress, AnIsotropicLawWrittenAsAMatrixIsTheIsotropicLaw) {
  const mesh::TetMesh mesh = test::bent(mesh::to_order(test::box_mesh({3, 2, 2}, kBoxSize), 3), 5);
  const Solid matrix({Law{kGlass, isotropic_stiffness(kGlass)}}, {});
  std::mt19937 random(3);
  std::normal_distribution<double> number;
  Eigen::MatrixXd shapes(3 * mesh.nodes.rows(), 4);
  for (double& x : shapes.reshaped()) x = number(random);
  const SurfaceStress plain = surface_stress(mesh, kGlass, shapes), full = surface_stress(mesh, matrix, shapes);
  EXPECT_LT((plain.components - full.components).norm(), 1e-12 * plain.components.norm());
  EXPECT_LT((plain.largest - full.largest).norm(), 1e-12 * plain.largest.norm());
}

// Wood stretched along its grain, which lies across the axes of the mesh: the compliance gives the strain.
TEST(SurfaceStress, WoodUnderTensionHasThatTension) {
  const EngineeringConstants spruce{{11e9, 0.9e9, 0.5e9}, {0.37, 0.42, 0.47}, {0.7e9, 0.65e9, 0.05e9}};
  const double angle = 0.4;  // about z
  Eigen::Matrix3d axes;
  axes << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
  const Matrix6 c = rotated(orthotropic_stiffness(spruce).value(), axes);
  const Solid wood({Law{.elastic = {.density_kg_m3 = 450}, .stiffness_pa = c}}, {});
  const mesh::TetMesh box = mesh::to_order(test::box_mesh({3, 2, 2}, kBoxSize), 2);
  Eigen::Matrix<double, 6, 1> tension = Eigen::Matrix<double, 6, 1>::Zero();
  tension[0] = 1e6;  // along the mesh's x
  const Eigen::Matrix<double, 6, 1> e = c.fullPivLu().solve(tension);
  Eigen::Matrix3d gradient;
  gradient << e[0], e[5] / 2, e[4] / 2, e[5] / 2, e[1], e[3] / 2, e[4] / 2, e[3] / 2, e[2];
  const SurfaceStress stress =
      surface_stress(box, wood, sampled(box, [&](const auto& x) { return Eigen::Vector3d(gradient * x); }));
  for (Eigen::Index p = 0; p < stress.positions.rows(); ++p) {
    const bool end = std::abs(stress.normals(p, 0)) > 0.5;  // across the tension: nothing within the skin
    if (end) continue;
    const Eigen::Matrix3d truth = Eigen::Vector3d(1e6, 0, 0).asDiagonal();
    EXPECT_LT((tensor_at(stress, p) - truth).norm(), 1e-8 * 1e6);
  }
}

TEST(SurfaceStress, EachPartHasItsOwnLaw) {
  const mesh::TetMesh box = mesh::to_order(test::box_mesh({3, 2, 2}, kBoxSize), 1);
  std::vector<std::int32_t> law_of;
  for (Eigen::Index e = 0; e < box.elements.rows(); ++e) {
    const Eigen::Vector3d centre = mesh::corners_of(box, e).colwise().mean();
    law_of.push_back(centre[0] > 0.034 ? 1 : 0);
  }
  const Elastic soft{7.2e9, 0.23, 2530};
  const SurfaceStress stress = surface_stress(box, Solid({Law{kGlass}, Law{soft}}, law_of),
                                              sampled(box, [](const auto& x) { return Eigen::Vector3d(x[0], 0, 0); }));
  for (Eigen::Index p = 0; p < stress.positions.rows(); ++p) {
    if (std::abs(stress.normals(p, 0)) > 0.5) continue;
    const double youngs = stress.positions(p, 0) < 0.1 / 3 ? 72e9 : 7.2e9;
    EXPECT_NEAR(tensor_at(stress, p)(0, 0), youngs / (1 - 0.23 * 0.23), 1e-9 * youngs);
  }
}

TEST(SurfaceStress, PointsAreOnTheSkinAndWellSpread) {
  const mesh::TetMesh box = mesh::to_order(test::box_mesh({5, 4, 3}, kBoxSize), 2);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(3 * box.nodes.rows(), 1);
  const SurfaceStress stress = surface_stress(box, kGlass, none, 100);
  ASSERT_EQ(stress.positions.rows(), 100);
  const double area = 2 * (0.1 * 0.08 + 0.08 * 0.06 + 0.06 * 0.1), apart = std::sqrt(area / 100);
  double closest = 1;
  for (Eigen::Index p = 0; p < 100; ++p) {
    const Eigen::Array3d at = stress.positions.row(p).transpose().array();
    const double inside = std::min(at.minCoeff(), (kBoxSize.array() - at).minCoeff());
    EXPECT_NEAR(inside, 0, 1e-12);
    const Eigen::Vector3d first = stress.first.row(p), second = stress.second.row(p), normal = stress.normals.row(p);
    EXPECT_LT((first.cross(second) - normal).norm(), 1e-12);
    EXPECT_NEAR(first.norm(), 1, 1e-12);
    for (Eigen::Index o = 0; o < p; ++o)
      closest = std::min(closest, (stress.positions.row(p) - stress.positions.row(o)).norm());
  }
  EXPECT_GT(closest, 0.5 * apart);
  // No place on the skin is far from all of them.
  double farthest = 0;
  for (const std::int32_t node : mesh::boundary_of(box).nodes)
    farthest = std::max(farthest, (stress.positions.rowwise() - box.nodes.row(node)).rowwise().norm().minCoeff());
  EXPECT_LT(farthest, 1.5 * apart);
  const Eigen::Index all = 9 * static_cast<Eigen::Index>(mesh::outer_faces(box.elements).size());
  EXPECT_EQ(surface_stress(box, kGlass, none, 1000000).positions.rows(), all);
}

TEST(SurfaceStress, TheLargestIsThatOfAllPointsAndBothPhases) {
  const mesh::TetMesh mesh = test::bent(mesh::to_order(test::box_mesh({3, 2, 2}, kBoxSize), 3), 5);
  std::mt19937 random(4);
  std::normal_distribution<double> number;
  Eigen::MatrixXd shapes(3 * mesh.nodes.rows(), 3);
  for (double& x : shapes.reshaped()) x = number(random);
  const SurfaceStress few = surface_stress(mesh, kGlass, shapes, 5),
                      all = surface_stress(mesh, kGlass, shapes, 1000000);
  EXPECT_EQ(few.largest, all.largest);
  for (Eigen::Index m = 0; m < 3; ++m) {
    double truth = 0;
    for (Eigen::Index p = 0; p < all.positions.rows(); ++p) {
      const Eigen::Vector3d values = dense::spectrum_of_3(tensor_at(all, p, m)).values;
      truth = std::max(truth, values.cwiseAbs().maxCoeff());
    }
    EXPECT_NEAR(all.largest[m], truth, 1e-9 * truth);
  }
}

TEST(SurfaceStress, TheKeptPointsHaveTheLargestStressOfEachMode) {
  const mesh::TetMesh mesh = test::bent(mesh::to_order(test::box_mesh({4, 3, 2}, kBoxSize), 2), 5);
  std::mt19937 random(6);
  std::normal_distribution<double> number;
  Eigen::MatrixXd shapes(3 * mesh.nodes.rows(), 10);
  for (double& x : shapes.reshaped()) x = number(random);
  const SurfaceStress stress = surface_stress(mesh, kGlass, shapes, 40);
  EXPECT_EQ(stress.positions.rows(), 40);
  for (Eigen::Index m = 0; m < 10; ++m) {
    double truth = 0;
    for (Eigen::Index p = 0; p < 40; ++p) {
      const Eigen::Vector3d values = dense::spectrum_of_3(tensor_at(stress, p, m)).values;
      truth = std::max(truth, values.cwiseAbs().maxCoeff());
    }
    EXPECT_NEAR(stress.largest[m], truth, 1e-9 * truth);
  }
}

// Stress of mass-normalised shapes goes as stiffness / (density^1/2 size^5/2).
TEST(SurfaceStress, StressScalesByDimensions) {
  const mesh::TetMesh small = mesh::to_order(test::box_mesh({2, 2, 2}, kBoxSize), 2);
  mesh::TetMesh large = small;
  large.nodes *= 3;
  Eigen::MatrixXd shapes(3 * small.nodes.rows(), 1);
  std::mt19937 random(5);
  std::normal_distribution<double> number;
  for (double& x : shapes.reshaped()) x = number(random);
  const Elastic other{5 * 72e9, 0.23, 2 * 2530};
  const Eigen::MatrixXd normalised = shapes / std::sqrt(2 * std::pow(3, 3));
  const double before = surface_stress(small, kGlass, shapes).largest[0];
  const double after = surface_stress(large, other, normalised).largest[0];
  EXPECT_NEAR(after, before * 5 / (std::sqrt(2) * std::pow(3, 2.5)), 1e-9 * after);
}

}  // namespace
}  // namespace ringdown::fem
