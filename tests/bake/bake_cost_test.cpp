// The estimates of a bake's cost, held against what the bakes of the presets counted.
#include "engine/bake/bake_cost.h"
#include "engine/modal/bank_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

namespace ringdown::bake_cost_test {
namespace {

namespace fs = std::filesystem;

mesh::TriangleMesh skin_of_bank(const modal::Bank& bank) {
  mesh::TriangleMesh skin;
  skin.nodes.resize(static_cast<Eigen::Index>(bank.positions.size()), 3);
  for (std::size_t p = 0; p < bank.positions.size(); ++p) {
    const auto& [x, y, z] = bank.positions[p];
    skin.nodes.row(static_cast<Eigen::Index>(p)) << x, y, z;
  }
  skin.triangles.resize(static_cast<Eigen::Index>(bank.triangles.size()), 3);
  for (std::size_t t = 0; t < bank.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      skin.triangles(static_cast<Eigen::Index>(t), i) = static_cast<std::int32_t>(bank.triangles[t][i]);
    }
  }
  return skin;
}

// Bars, plates, shells and solid bodies: their bakes counted modes by inertia. Fewer are expected than half of the
// coin's 9, the horseshoe's 20, the gong's 67 and the fork's 44.
TEST(BakeCost, TheModesOfMostFreePresetsAreExpectedWithinAFactorOfTwo) {
  int compared = 0, near = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(RINGDOWN_SOURCE_DIR) / "presets/banks")) {
    if (entry.path().extension() != ".glb") continue;
    const auto bank = modal::read_bank(entry.path());
    ASSERT_TRUE(bank) << bank.error().message;
    const modal::Provenance& made = bank->provenance;
    if (bank->held || bank->material->orthotropy || !made.parts.empty() || !made.liquids.empty()) continue;
    const auto counted = static_cast<double>(made.counted_modes - made.rigid_modes);
    const double expected =
        bake::expected_modes(bake::measure_shape(skin_of_bank(*bank), 0), *bank->material, made.band_high_hz);
    ++compared;
    near += std::max(expected / counted, counted / expected) <= 2;
  }
  EXPECT_GE(compared, 30);
  EXPECT_GE(near, compared - 4);
}

}  // namespace
}  // namespace ringdown::bake_cost_test
