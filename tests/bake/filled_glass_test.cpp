// The preset wine glass, dry and filled, against Fourier finite elements in the meridian plane of its exact geometry.
#include "engine/bake/bake_object.h"
#include "engine/bake/object_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace ringdown::filled_glass_test {
namespace {

namespace fs = std::filesystem;

const fs::path kPresets = fs::path(RINGDOWN_SOURCE_DIR) / "presets";

std::vector<double> frequencies(const std::string& fill) {
  auto recipe = bake::parse_object(
      "material = \"glass\"\ngeometry = \"wine-glass.geo\"\nunit_m = 0.001\nmesh_size_m = 0.006\nshape_error = 0.3\n"
      "band_hz = [20, 4000]\n" +
          fill,
      kPresets / "objects" / "filled.toml");
  EXPECT_TRUE(recipe) << recipe.error().message;
  recipe->options.cache.clear();
  const auto baked = bake::bake_object(*recipe, kPresets / "materials");
  EXPECT_TRUE(baked) << baked.error().message;
  if (!baked) return {};
  std::vector<double> sorted = baked->baked.bank.frequency_hz;
  std::ranges::sort(sorted);
  return sorted;
}

// The two modes next to a frequency.
std::pair<double, double> pair_near(const std::vector<double>& sorted, double hz) {
  std::vector<double> near = sorted;
  std::ranges::sort(near, {}, [hz](double f) { return std::abs(f - hz); });
  return {std::min(near[0], near[1]), std::max(near[0], near[1])};
}

// m = 2, 3, 4, and with compressible water m = 0.
TEST(FilledGlass, BrimFullItHasTheModesOfTheReference) {
  const std::vector<double> wet = frequencies("[fill]\nfull = true\n");
  ASSERT_GE(wet.size(), 8u);
  for (const double exact_hz : {636.6, 1840.7, 3589.4}) {
    const auto [low, high] = pair_near(wet, exact_hz);
    EXPECT_NEAR(low / exact_hz, 1, 0.005);
    EXPECT_NEAR(high / exact_hz, 1, 0.005);
    EXPECT_LT(1200 * std::log2(high / low), 1) << "cents, of a pair";
  }
  EXPECT_NEAR(*std::ranges::min_element(wet, {}, [](double f) { return std::abs(f - 3923); }) / 3923, 1, 0.005);
}

}  // namespace
}  // namespace ringdown::filled_glass_test
