// The power that leaves the surface is that which arrives far away.
#include "tests/radiate/surface_power.h"

#include "engine/radiate/far_field.h"
#include "engine/radiate/skin.h"
#include "engine/radiate/wave_solver.h"
#include "tests/radiate/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace ringdown::surface_power_test {
namespace {

constexpr double kPi = std::numbers::pi;

struct Powers {
  double far_w = 0;
  radiate::SurfacePower surface;
};

// All modes of the body at one wavenumber, on one skin, by elimination.
std::vector<Powers> powers_of(const radiate::Body& body, double k, double side_m) {
  const auto original = radiate::Original::of(body);
  const auto skin = original ? radiate::skin_of(*original, side_m) : fail(original.error());
  EXPECT_TRUE(skin);
  if (!skin) return {};
  const std::vector<double> coupling = radiate::coupling_of(*skin, k);
  radiate::ComplexMatrix matrix;
  radiate::wave_matrix(skin->panels, 0, skin->near[0], k, coupling, matrix);
  const Eigen::MatrixXcd layers =
      radiate::LuFactors(matrix).solve(skin->flow[0].cast<std::complex<float>>()).cast<std::complex<double>>();
  const modal::Air air;
  const auto surface =
      radiate::surface_power(skin->panels, k, coupling, layers, radiate::triangle_flow(skin->panels, body.flow), air);
  const radiate::Directions directions = radiate::directions_for(20);
  const Eigen::MatrixXcd fields =
      radiate::far_fields(skin->panels, Eigen::Vector3d::Zero(), k, coupling, directions, layers);
  std::vector<Powers> powers;
  for (Eigen::Index m = 0; m < fields.cols(); ++m) {
    const double rms = std::sqrt(directions.weights.dot(fields.col(m).cwiseAbs2()) / (4 * kPi));
    powers.push_back({modal::radiated_power(rms, k * air.sound_speed_m_s, air), surface[static_cast<std::size_t>(m)]});
  }
  return powers;
}

// The errors of the pressure are some thousandths of what flows back and forth, of which power is but a share.
TEST(SurfacePower, OfASphereIsThatOfTheFarFieldToHalfAPerCentOfWhatFlowsBackAndForth) {
  const double a = 0.1;
  radiate::Body body{.surface = sphere(a, 12), .flow = {}, .frequency_hz = {100, 100, 100, 100}};
  body.flow = sample(
      body.surface, 4, [&](int n, const auto& at, const auto&) { return std::legendre(n, at[2] / at.norm()); }, 0.02);
  int exact = 0;
  for (const double ka : {0.3, 1.0, 4.0}) {
    const std::vector<Powers> powers = powers_of(body, ka / a, 0.018);
    ASSERT_EQ(powers.size(), 4U);
    for (int n = 0; n < 4; ++n) {
      const Powers& power = powers[static_cast<std::size_t>(n)];
      const double back_and_forth_w = std::abs(power.surface.power_w) / power.surface.share;
      const double allowed_w = 0.02 * power.far_w + 0.005 * back_and_forth_w;
      EXPECT_NEAR(power.surface.power_w, power.far_w, allowed_w) << "n " << n << " ka " << ka;
      exact += allowed_w < 0.05 * power.far_w ? 1 : 0;
    }
  }
  EXPECT_GE(exact, 6);
}

TEST(SurfacePower, OfABendingPlateIsThatOfTheFarField) {
  radiate::Body body{.surface = box({0.12, 0.08, 0.003}, 0.008), .flow = {}, .frequency_hz = {100, 100}};
  body.flow = sample(
      body.surface, 2,
      [](int m, const Eigen::Vector3d& at, const Eigen::Vector3d& normal) {
        return normal[2] * std::cos((m + 1) * kPi * at[0] / 0.12) * std::cos(m * kPi * at[1] / 0.08);
      },
      0.004);
  for (const double frequency_hz : {2500.0, 8000.0}) {
    const double k = 2 * kPi * frequency_hz / modal::Air{}.sound_speed_m_s;
    for (const Powers& power : powers_of(body, k, 0.008)) {
      EXPECT_NEAR(10 * std::log10(power.surface.power_w / power.far_w), 0, 0.3)
          << frequency_hz << " Hz, share " << power.surface.share;
    }
  }
}

}  // namespace
}  // namespace ringdown::surface_power_test
