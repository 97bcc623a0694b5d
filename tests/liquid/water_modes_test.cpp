// The modes of a liquid between walls at rest, against closed forms.
#include "engine/liquid/potential.h"
#include "engine/liquid/water_modes.h"
#include "tests/liquid/turned_vessel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace ringdown::liquid {
namespace {

// A cup of radius 1 with a flat floor, filled to h: kappa^2 = j'_ms^2 + ((2 i - 1) pi / 2h)^2, with j' the zeros of the
// slopes of Bessel's functions (0, 1.8412, 3.0542, 3.8317, 4.2012; pairs from m = 1 on).
TEST(WaterModes, CupHasTheModesOfACylinder) {
  const double h = 1.5;
  const Skin skin = flat_skin(turned({{0, -0.1}, {1.1, -0.1}, {1.1, 2}, {1, 2}, {1, 0}, {0, 0}}, 0.05, 144));
  const WetWall wall(skin, {0, 0, 1});
  const Wetted liquid = wetted_by(wall, {piece_of(wall, basins_of(wall).front(), h)}, h, false);
  const Result<WetPanels> panels = WetPanels::of(liquid, 800, 1);
  ASSERT_TRUE(panels) << panels.error().message;
  const WaterModes modes(liquid, panels->panels());
  std::vector<double> exact;
  for (int i = 1; i < 4; ++i) {
    const double k = (2 * i - 1) * std::numbers::pi / (2 * h);
    for (const double j : {0.0, 1.84118378, 1.84118378, 3.05423693, 3.05423693, 3.83170597, 4.20118894, 4.20118894})
      exact.push_back(std::hypot(j, k));
  }
  std::ranges::sort(exact);
  for (std::size_t n = 0; n < 10; ++n)
    EXPECT_NEAR(modes.wavenumbers()[static_cast<Eigen::Index>(n)] / exact[n], 1, 0.002) << n;
  // The modes have a unit square over the liquid, so at the middle of the floor the lowest is sqrt(2 / (pi h)).
  mesh::Points floor(1, 3);
  floor << h, 0, 0;
  EXPECT_NEAR(std::abs(modes.values(floor)(0, 0)), std::sqrt(2 / (std::numbers::pi * h)), 0.003);
}

}  // namespace
}  // namespace ringdown::liquid
