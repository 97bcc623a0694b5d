// The handover against a second way to compute it, from the faces of the crack alone. With t_j the traction of the
// body's mode j on the faces that will be crack, Green's formula over the piece says
//
//   (lambda_k - lambda_j) P_kj = integral over the crack of t_j . psi_k
//
// Tractions of finite elements are not exact, so the two sides are equal to the elements' accuracy only.
#include "engine/bake/shatter_body.h"
#include "engine/mesh/face_points.h"
#include "engine/mesh/tet_element.h"
#include "engine/shatter/piece_mesh.h"
#include "engine/shatter/pieces.h"
#include "tests/shatter/bodies.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace ringdown::crack_traction_test {
namespace {

const modal::Material kGlass{"glass", 70e9, 0.22, 2500, {0, 0}};
const Eigen::Vector3d kSize(0.12, 0.08, 0.006);
constexpr int kRigid = 6, kOrder = 3;

// Points and weights of a triangle as a square whose one side is shrunk to a point, exact to degree 5.
struct TrianglePoint {
  double second, third, weight;  // coordinates of the corners; weights sum to 1
};
std::array<TrianglePoint, 16> triangle_rule() {
  constexpr std::array<double, 4> kAt = {0.06943184420297371, 0.33000947820757187, 0.6699905217924281,
                                         0.9305681557970263};
  constexpr std::array<double, 4> kWeight = {0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
                                             0.17392742256872693};
  std::array<TrianglePoint, 16> rule{};
  for (std::size_t i = 0; i < 16; ++i) {
    const double along = kAt[i / 4], across = kAt[i % 4];
    rule[i] = {along, (1 - along) * across, 2 * kWeight[i / 4] * kWeight[i % 4] * (1 - along)};
  }
  return rule;
}

bool on_skin(const Eigen::Vector3d& at) {
  return std::min(at.cwiseAbs().minCoeff(), (kSize - at).cwiseAbs().minCoeff()) < 1e-9;
}

// The integrals over all cracks of the piece, K x M.
Eigen::MatrixXd work_of_tractions(const mesh::TetMesh& mesh, const Eigen::MatrixXd& own, const Eigen::MatrixXd& body) {
  const fem::Elastic glass{kGlass.youngs_modulus_pa, kGlass.poisson_ratio, kGlass.density_kg_m3};
  const mesh::FacePoints faces = mesh::face_points(mesh);
  Eigen::MatrixXd work = Eigen::MatrixXd::Zero(own.cols(), body.cols());
  for (std::size_t f = 0; f < faces.elements.size(); ++f) {
    const Eigen::Index element = faces.elements[f];
    const int opposite = faces.opposite[f];
    const mesh::Corners corners = mesh::corners_of(mesh, element);
    std::array<int, 3> face{};
    for (int c = 0, next = 0; c < 4; ++c) {
      if (c != opposite) face[next++] = c;
    }
    const Eigen::RowVector3d a = corners.row(face[0]), b = corners.row(face[1]), c = corners.row(face[2]);
    if (on_skin((a + b + c).transpose() / 3)) continue;
    Eigen::Vector3d normal = (b - a).cross(c - a).transpose();
    const double area_m2 = normal.norm() / 2;
    normal.normalize();
    if (normal.dot((corners.row(opposite) - a).transpose()) > 0) normal = -normal;
    const Eigen::Matrix3d to_space = mesh::jacobian(corners).inverse();
    for (const auto& [second, third, weight] : triangle_rule()) {
      Eigen::Vector4d at = Eigen::Vector4d::Zero();
      at[face[0]] = 1 - second - third, at[face[1]] = second, at[face[2]] = third;
      const Eigen::VectorXd values = mesh::interpolation(kOrder, at);
      const Eigen::MatrixXd slopes = mesh::interpolation_gradient(kOrder, at) * to_space.transpose();
      Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(3, own.cols()), tractions(3, body.cols());
      for (Eigen::Index n = 0; n < values.size(); ++n)
        moved += values[n] * own.middleRows<3>(3 * mesh.elements(element, n));
      for (Eigen::Index j = 0; j < body.cols(); ++j) {
        Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
        for (Eigen::Index n = 0; n < values.size(); ++n)
          gradient += body.col(j).segment<3>(3 * mesh.elements(element, n)) * slopes.row(n);
        tractions.col(j) = glass.lambda_pa() * gradient.trace() * normal +
                           glass.mu_pa() * (gradient + gradient.transpose()) * normal;
      }
      work += weight * area_m2 * moved.transpose() * tractions;
    }
  }
  return work;
}

double lambda_of(const modal::Bank& bank, std::size_t mode) {
  return std::pow(2 * M_PI * bank.frequency_hz[mode], 2) + std::pow(bank.decay_per_s[mode], 2);
}

TEST(CrackTraction, TheHandoverIsTheWorkOfTheTractionsThatEnd) {
  const mesh::TetMesh plate = mesh::to_order(test::box_mesh({8, 6, 1}, kSize), kOrder);
  const bake::BakeOptions options{.element = test::element_of(plate), .band_high_hz = 12e3, .interior = true};
  const bake::Baked whole = bake::bake(test::checked(plate), kGlass, options, "plate").value();
  const Vec3 place{0.05, 0.03, 0};
  const bake::Shatter shatter{
      .pieces = {3}, .pattern = shatter::Pattern::kUniform, .places_m = {place}, .band_high_hz = 20e3};
  const modal::Fracture fracture = bake::shatter_body(whole, shatter, options).value();
  const mesh::TetMesh& mesh = whole.body->mesh;
  const auto seeds = shatter::make_seeds(
      mesh, {.pattern = shatter.pattern, .pieces = shatter.pieces, .impact_m = place, .seed = shatter.seed});
  const shatter::CutBody cut = shatter::cut_body(mesh, seeds->points).value();
  const shatter::Level level = levels_of(cut, mesh, seeds->group_of_cell).front();
  const std::size_t modes = whole.bank.mode_count();
  ASSERT_GE(modes, 8u);
  int compared = 0;
  double largest = 0, off = 0;
  for (std::int32_t s = 0; s < std::ssize(level.pieces); ++s) {
    const modal::PieceBank& piece = fracture.patterns.front().pieces[s];
    if (piece.bank.mode_count() == 0) continue;
    const shatter::PieceMesh own = piece_mesh(cut, mesh, elements_of(level, s));
    const bake::Baked baked = bake::bake({.mesh = own.mesh, .pieces = 1}, kGlass,
                                         {.element = options.element,
                                          .band_high_hz = shatter.band_high_hz,
                                          .may_be_silent = true,
                                          .interior = true},
                                         "piece")
                                  .value();
    ASSERT_EQ(baked.bank.frequency_hz, piece.bank.frequency_hz);
    const Eigen::MatrixXd work =
        work_of_tractions(own.mesh, baked.body->shapes, restricted(own, mesh, whole.body->shapes));
    for (std::size_t k = 0; k < piece.bank.mode_count(); ++k) {
      for (std::size_t j = 0; j < modes; ++j) {
        const double p = piece.handover[(kRigid + k) * (kRigid + modes) + kRigid + j];
        const double from_handover = (lambda_of(piece.bank, k) - lambda_of(whole.bank, j)) * p;
        largest = std::max(largest, std::abs(from_handover));
        off = std::max(off, std::abs(from_handover - work(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(j))));
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 50);
  EXPECT_LT(off, 0.01 * largest);
}

}  // namespace
}  // namespace ringdown::crack_traction_test
