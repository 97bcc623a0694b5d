// Presets that break, struck harder and harder until the stress of their modes away from the blow is their strength.
// Stress is linear in the impulse, so one search gives the impulse for every strength.
#include "engine/modal/bank_file.h"
#include "engine/modal/fracture/fracture.h"
#include "engine/modal/material_scale.h"
#include "engine/modal/strike_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace ringdown::modal {
namespace {

std::shared_ptr<const Bank> preset(const std::string& name) {
  const auto file = std::filesystem::path(RINGDOWN_SOURCE_DIR) / "presets/banks" / (name + ".glb");
  auto bank = read_bank(file);
  EXPECT_TRUE(bank) << (bank ? "" : bank.error().message);
  return std::make_shared<const Bank>(std::move(*bank));
}

struct Hit {
  Vec3 at_m, direction;
  double contact_time_s = 1e-4;
  double spared_radius_m = 0.03;
};

// Largest tensile stress for each newton second [Pa/(N s)].
double stress_per_ns(const std::shared_ptr<const Bank>& bank, const Hit& hit) {
  std::vector<DampedMode> modes;
  for (std::size_t m = 0; m < bank->mode_count(); ++m) modes.push_back(rescale(*bank, m, {}));
  const ModalState state = at_rest(modes, *bank->mass);
  std::vector<double> impulse(modes.size());
  StrikeMap(bank).excite(hit.at_m, hit.direction, impulse);
  const Blow blow{impulse, hit.at_m, hit.direction, hit.contact_time_s};
  const double found =
      peak_stress(bank->fracture->stress, state, &blow, {.spared_m = hit.at_m, .spared_radius_m = hit.spared_radius_m})
          .stress_pa;
  EXPECT_LE(found, stress_bound_pa(bank->fracture->stress, state, &blow));
  return found;
}

// The impulses at which twenty bodies break, ascending [N s].
std::vector<double> breaking_impulses_ns(const Bank& bank, double per_ns) {
  std::vector<double> impulses;
  for (std::uint64_t body = 0; body < 20; ++body)
    impulses.push_back(drawn_strength_pa(*bank.fracture->strength, bank.fracture->skin_m2, 1, body) / per_ns);
  std::ranges::sort(impulses);
  return impulses;
}

// A prototype with elements of its own found 44.5 MPa farther than 3 cm from a blow of 0.05 N s in 0.1 ms.
TEST(PresetStrength, APaneIsStressedAsThePrototypesPane) {
  const auto pane = preset("window-pane");
  ASSERT_TRUE(pane->fracture);
  const double per_ns = stress_per_ns(pane, {.at_m = {0.03, 0.02, 0.0015}, .direction = {0, 0, -1}});
  std::printf("pane: %.3g MPa at 0.05 N s\n", 0.05 * per_ns / 1e6);
  EXPECT_NEAR(0.05 * per_ns, 44.5e6, 0.15 * 44.5e6);
}

TEST(PresetStrength, ImpulsesThatBreakThePresets) {
  struct Case {
    const char* name;
    Hit hit;
  };
  const Case cases[] = {
      {"window-pane", {.at_m = {0.03, 0.02, 0.0015}, .direction = {0, 0, -1}}},
      {"tumbler", {.at_m = {0.04, 0, 0.1}, .direction = {-1, 0, 0}}},
      {"wine-glass", {.at_m = {0.034, 0, 0.15}, .direction = {-1, 0, 0}}},
      {"bottle", {.at_m = {0.037, 0, 0.15}, .direction = {-1, 0, 0}}},
      {"dinner-plate", {.at_m = {0, 0, 0.0045}, .direction = {0, 0, -1}}},
      {"flower-pot", {.at_m = {0.068, 0, 0.115}, .direction = {-1, 0, 0}}},
      {"ceramic-tile", {.at_m = {0, 0, 0.0035}, .direction = {0, 0, -1}}},
  };
  for (const auto& [name, hit] : cases) {
    const auto bank = preset(name);
    ASSERT_TRUE(bank->fracture && bank->fracture->strength) << name;
    const double per_ns = stress_per_ns(bank, hit);
    ASSERT_GT(per_ns, 0) << name;
    const auto all = breaking_impulses_ns(*bank, per_ns);
    std::printf("%s: %.3g MPa/(N s); breaks at %.3g to %.3g N s, half by %.3g\n", name, per_ns / 1e6, all.front(),
                all.back(), all[10]);
  }
}

}  // namespace
}  // namespace ringdown::modal
