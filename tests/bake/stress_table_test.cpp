// The bake of a body that breaks also says how its modes stress its skin, how strong it is and what its cracks cost.
#include "engine/bake/shatter_body.h"
#include "tests/shatter/bodies.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

namespace ringdown::stress_table_test {
namespace {

const modal::Material kGlass{"glass", 70e9, 0.22, 2500, {0.5, 2e-9}};
const Eigen::Vector3d kSize(0.12, 0.08, 0.004);

// A pane of linear elements, in which each element has one strain.
const bake::Baked& whole_pane() {
  static const bake::Baked whole =
      bake::bake(test::checked(test::box_mesh({6, 4, 1}, kSize)), kGlass,
                 {.element = fem::Element::kTet4, .band_high_hz = 30e3, .interior = true}, "pane")
          .value();
  return whole;
}

modal::Fracture broken(const modal::Material& material) {
  bake::Baked whole{.bank = whole_pane().bank, .body = whole_pane().body, .report = {}};
  whole.bank.material = material;
  return bake::shatter_body(whole, {.pieces = {2}, .band_high_hz = 2e3}, {.element = fem::Element::kTet4}).value();
}

TEST(StressTable, SkinStrengthAndCrackEnergyAreThoseOfTheBody) {
  modal::Material brittle = kGlass;
  brittle.brittleness = {.strength = {5e7, 6, 2e-3}, .toughness_pa_sqrt_m = 0.7e6};
  const modal::Fracture fracture = broken(brittle);
  EXPECT_NEAR(fracture.skin_m2, 2 * (0.12 * 0.08 + 0.12 * 0.004 + 0.08 * 0.004), 1e-12);
  EXPECT_EQ(fracture.strength.value().strength_pa, 5e7);
  EXPECT_EQ(fracture.strength->reference_area_m2, 2e-3);
  EXPECT_NEAR(fracture.crack_energy_j_m2, 0.49e12 * (1 - 0.22 * 0.22) / 70e9, 1e-9);
}

TEST(StressTable, ADuctileBodyHasStressButNoStrength) {
  const modal::Fracture fracture = broken(kGlass);
  EXPECT_FALSE(fracture.strength);
  EXPECT_EQ(fracture.crack_energy_j_m2, 0);
  EXPECT_FALSE(fracture.stress.positions.empty());
}

// Displacement gradients of all modes at a place, 9 x M, column after column: those of the element around it.
Eigen::MatrixXd gradients_at(const bake::SolvedBody& body, const Eigen::Vector3d& at) {
  double best = -1;
  Eigen::MatrixXd gradients;
  for (Eigen::Index e = 0; e < body.mesh.elements.rows(); ++e) {
    const auto corner = [&](int c) { return body.mesh.nodes.row(body.mesh.elements(e, c)).transpose(); };
    Eigen::Matrix3d edges;
    for (int c = 1; c < 4; ++c) edges.col(c - 1) = corner(c) - corner(0);
    const Eigen::Vector3d inner = edges.inverse() * (at - corner(0));
    const double least = std::min(inner.minCoeff(), 1 - inner.sum());
    if (least <= best) continue;
    best = least;
    gradients.resize(9, body.shapes.cols());
    for (Eigen::Index m = 0; m < body.shapes.cols(); ++m) {
      const auto moved = [&](int c) { return body.shapes.col(m).segment<3>(3 * body.mesh.elements(e, c)); };
      Eigen::Matrix3d stretched;
      for (int c = 1; c < 4; ++c) stretched.col(c - 1) = moved(c) - moved(0);
      const Eigen::Matrix3d gradient = stretched * edges.inverse();
      gradients.col(m) = gradient.reshaped();
    }
  }
  EXPECT_GT(best, -1e-6) << "the point is outside of the body";
  return gradients;
}

// The sum of the two stresses along the skin is E / (1 - nu) times the divergence along the skin, whatever the tangents.
TEST(StressTable, TheTableHasTheStressOfTheBanksModesInTheirOrder) {
  const bake::SolvedBody& body = *whole_pane().body;
  const modal::StressTable table = broken(kGlass).stress;
  const std::size_t modes = whole_pane().bank.mode_count();
  ASSERT_GE(modes, 4u);
  ASSERT_EQ(table.largest.size(), modes);
  ASSERT_EQ(table.stress.size(), 3 * table.positions.size() * modes);
  EXPECT_GT(table.positions.size(), 200u);
  for (std::size_t p = 0; p < table.positions.size(); ++p) {
    const Eigen::Vector3d at = Eigen::Vector3f(table.positions[p].data()).cast<double>();
    int across = 0;  // the axis across the face
    at.cwiseAbs().cwiseMin((kSize - at).cwiseAbs()).minCoeff(&across);
    const Eigen::MatrixXd gradients = gradients_at(body, at);
    for (std::size_t m = 0; m < modes; ++m) {
      const auto column = static_cast<Eigen::Index>(m);
      const double divergence = gradients(0, column) + gradients(4, column) + gradients(8, column) -
                                gradients(4 * across, column);
      const double s11 = table.stress[3 * p * modes + m], s22 = table.stress[(3 * p + 1) * modes + m],
                   s12 = table.stress[(3 * p + 2) * modes + m], largest = table.largest[m];
      EXPECT_NEAR(s11 + s22, 70e9 / (1 - 0.22) * divergence, 1e-5 * largest);
      EXPECT_LE(std::abs(s11 + s22) / 2 + std::hypot((s11 - s22) / 2, s12), 1.00001 * largest);
    }
  }
}

}  // namespace
}  // namespace ringdown::stress_table_test
