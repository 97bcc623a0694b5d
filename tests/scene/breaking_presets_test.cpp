// Glasses fall onto stone. Strengths are those of the material's sources, drawn for twenty seeds; orientation and
// height decide.
#include "engine/breaking/breakable.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/fracture/fracture.h"
#include "engine/modal/strike_map.h"
#include "engine/scene/scene_file.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace ringdown::scene {
namespace {

constexpr std::size_t kSeeds = 20;

struct Preset {
  explicit Preset(const std::string& name)
      : bank(std::make_shared<const modal::Bank>(
            modal::read_bank(std::filesystem::path(RINGDOWN_SOURCE_DIR) / "presets/banks" / (name + ".glb")).value())),
        map(std::make_shared<const modal::StrikeMap>(bank)) {
    for (std::size_t p = 0; p < bank->fracture->patterns.size(); ++p)
      pieces.push_back(std::make_shared<const breaking::PieceSet>(*map, modal::MaterialScale{}, p));
  }
  std::shared_ptr<const modal::Bank> bank;
  std::shared_ptr<const modal::StrikeMap> map;
  std::vector<std::shared_ptr<const breaking::PieceSet>> pieces;
};

struct Fallen {
  std::size_t broken = 0, pieces = 0;
};

// Returns how many of twenty bodies, turned by `degrees` about the y axis, or at random without, break within `seconds`
// after they have fallen onto granite from this height, and into how many pieces together. Each has a strength of its
// own.
Fallen twenty_fall(const Preset& preset, std::optional<double> degrees, double height_m, double seconds) {
  std::mt19937 random(1);
  std::normal_distribution<double> any;
  std::vector<BodyDescription> bodies;
  std::vector<SoundingObject> objects;
  for (std::size_t i = 0; i < kSeeds; ++i) {
    const std::string name = "glass" + std::to_string(i);
    objects.push_back({name, static_cast<synth::ObjectNumber>(i), preset.bank, preset.map, preset.pieces});
    BodyDescription body = test::body_of(name, ShapeType::convex, {});
    body.rotation = about({0, 1, 0}, degrees.value_or(0) * std::numbers::pi / 180);
    if (!degrees) {  // the rotation by any quaternion
      const Vec3 axis{any(random), any(random), any(random)};
      body.rotation = about(axis, 2 * std::atan2(length(axis), any(random)));
    }
    double lowest_m = 0;
    for (const modal::Vec3f& p : preset.bank->positions)
      lowest_m = std::min(lowest_m, rotated(body.rotation, Vec3{p[0], p[1], p[2]}).z);
    body.position_m = {static_cast<double>(i), 0, 0.001 - lowest_m};
    body.velocity_m_s.z = -std::sqrt(2 * 9.81 * height_m);
    body.breaks.emplace();
    bodies.push_back(body);
  }
  SceneDescription scene = test::scene_of(std::move(bodies), 0.4);
  scene.statics[0].surface.young_pa = 50e9;
  World world = test::world_of(scene, objects);
  Fallen fallen;
  while (world.time_s() < seconds && fallen.broken < kSeeds) {
    for (const std::string& notice : world.step().notices) {
      const auto at = notice.find("broke into ");
      if (at == std::string::npos || notice.find('.') < at) continue;  // a piece, which has a point in its name
      ++fallen.broken;
      fallen.pieces += std::stoul(notice.substr(at + 11));
    }
  }
  return fallen;
}

TEST(BreakingPresets, AGlassBreaksFromATableAndNotFromAHandsBreadth) {
  const Preset tumbler("tumbler");
  for (const double degrees : {90.0, 140.0}) {  // on its side, on its rim
    EXPECT_GE(twenty_fall(tumbler, degrees, 0.75, 0.05).broken, 18u) << degrees;
    EXPECT_EQ(twenty_fall(tumbler, degrees, 0.05, 0.3).broken, 0u) << degrees;
  }
  EXPECT_EQ(twenty_fall(tumbler, 0, 0.05, 0.1).broken, 0u) << "on its base";
}

TEST(BreakingPresets, HarderFallsMakeMorePieces) {
  const Preset tumbler("tumbler");
  const Fallen low = twenty_fall(tumbler, 90, 0.75, 0.05), high = twenty_fall(tumbler, 90, 3, 0.05);
  EXPECT_EQ(high.broken, kSeeds);
  EXPECT_GT(high.pieces * low.broken, low.pieces * high.broken);
}

// Flat presets break into as many pieces as the energy of the vibration pays for: N even cells of a plate of area A and
// thickness h have cracks of the length 2 (N A)^1/2, less half of the plate's outline, which is no crack. A crack costs
// three times G_c. Patterns are uneven, and the plate has a rim.
TEST(BreakingPresets, ThereAreAsManyPiecesAsTheEnergyPaysFor) {
  struct Flat {
    const char* name;
    double area_m2, outline_m, thickness_m;
  };
  constexpr double kRound_m = 0.13;  // radius of the plate
  for (const auto& [name, area_m2, outline_m, thickness_m] :
       {Flat{"ceramic-tile", 0.15 * 0.15, 4 * 0.15, 0.007}, Flat{"window-pane", 0.25 * 0.18, 2 * 0.43, 0.003},
        Flat{"dinner-plate", std::numbers::pi * kRound_m * kRound_m, 2 * std::numbers::pi * kRound_m, 0.0045}}) {
    const Preset preset(name);
    const Vec3 at_m = preset.bank->fracture->patterns[0].at_m;
    const auto blow = [&](double impulse_ns) { return synth::verb::Strike{at_m, {0, 0, -impulse_ns}, 1e-4}; };
    auto body = breaking::Breakable::make(preset.map, {}, 48000, 0).value();
    const auto energy_j = [&](double impulse_ns) {
      return modal::modal_energy(body.at_peak(blow(impulse_ns), 0)).total_j();
    };
    std::size_t pieces = 0;
    for (double impulse_ns = 0.01; impulse_ns < 1; impulse_ns *= 1.02) {
      const std::size_t level = body.affordable(body.levels_at(at_m), energy_j(impulse_ns));
      const std::size_t now = preset.pieces[level]->pieces().size();
      ASSERT_GE(now, pieces) << name << ": a harder blow makes fewer pieces";
      if (now == pieces) continue;
      if (pieces > 0) {  // here the blow begins to pay for this level
        const double crack_m2 = energy_j(impulse_ns) / (3 * preset.bank->fracture->crack_energy_j_m2);
        const double half_m = (crack_m2 / thickness_m + outline_m / 2) / 2;
        const double paid_for = half_m * half_m / area_m2;
        EXPECT_NEAR(paid_for / static_cast<double>(now), 1, 0.45) << name << ", " << now << " pieces";
      }
      pieces = now;
    }
    EXPECT_EQ(pieces, preset.pieces.back()->pieces().size()) << name;
  }
}

// Prints the table in docs/how/fracture.md.
TEST(BreakingPresets, DISABLED_TheTableOfFalls) {
  for (const char* name :
       {"tumbler", "wine-glass", "bottle", "window-pane", "dinner-plate", "ceramic-tile", "flower-pot"}) {
    const Preset preset(name);
    std::string row = std::string("| `") + name + "` |";
    for (const std::optional<double> degrees : {std::optional(0.0), {90.0}, {137.0}, {}}) {
      for (const double height_m : {0.05, 0.75}) {
        row += " " + std::to_string(twenty_fall(preset, degrees, height_m, 0.15).broken);
        row += height_m < 0.1 ? "," : " |";
      }
    }
    std::puts(row.c_str());
  }
}

// Prints the ten longest steps of the scene `bull`, in processor time.
TEST(BreakingPresets, DISABLED_TheCostOfBull) {
  const std::filesystem::path presets = std::filesystem::path(RINGDOWN_SOURCE_DIR) / "presets";
  const SceneDescription scene = read_scene(presets / "scenes/bull.toml", presets).value();
  std::vector<SoundingObject> objects;
  for (const ObjectDescription& object : scene.objects) {
    const Preset preset(object.bank.stem().string());
    objects.push_back(
        {object.name, static_cast<synth::ObjectNumber>(objects.size()), preset.bank, preset.map, preset.pieces});
  }
  World world = test::world_of(scene, objects);
  struct Cost {
    double ms = 0, at_s = 0;
    std::size_t bodies = 0;
    std::string notice;
  };
  std::vector<Cost> costs;
  const auto now_ms = [] {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
  };
  while (world.time_s() < scene.duration_s) {
    const double begin_ms = now_ms(), at_s = world.time_s();
    const StepReport report = world.step();
    costs.push_back({now_ms() - begin_ms, at_s, 0, report.notices.empty() ? "" : report.notices[0]});
    if (costs.back().ms > 2) costs.back().bodies = world.bodies().size();
  }
  std::ranges::sort(costs, std::ranges::greater(), &Cost::ms);
  for (std::size_t i = 0; i < 10; ++i)
    std::printf("%.2f ms at %.3f s, %zu bodies %s\n", costs[i].ms, costs[i].at_s, costs[i].bodies,
                costs[i].notice.c_str());
}

// A tile is thick, so most of its pieces have no mode below 20 kHz, and the others ring for a shorter time.
TEST(BreakingPresets, ATileBreaksDullyAndAPaneRings) {
  struct Ringing {
    double silent = 0;   // share of the pieces
    double decay_s = 0;  // in which a mode's energy falls to 1/e, weighted by the energy
  };
  const auto ringing_of = [](const std::string& name, Vec3 impulse_ns) {
    const Preset preset(name);
    const breaking::PieceSet& pieces = *preset.pieces.back();
    auto body = breaking::Breakable::make(preset.map, {}, 48000, 0).value();
    const Vec3 at_m = preset.bank->fracture->patterns.back().at_m;
    const modal::Broken broken = pieces.breaking()(body.at_peak({at_m, impulse_ns, 1e-4}, 100), 0);
    Ringing ringing;
    double all_j = 0;
    for (std::size_t i = 0; i < broken.pieces.size(); ++i) {
      const std::vector<modal::DampedMode>& modes = pieces.pieces()[i].modes;
      ringing.silent += modes.empty() ? 1 / static_cast<double>(broken.pieces.size()) : 0;
      for (std::size_t k = 0; k < modes.size(); ++k) {
        modal::ModalState one = modal::at_rest({modes[k]}, *preset.bank->mass);
        one.amplitudes[0] = broken.pieces[i].amplitudes[k];
        const double energy_j = modal::modal_energy(one).total_j();
        all_j += energy_j;
        ringing.decay_s += energy_j / (2 * modes[k].decay_per_s);
      }
    }
    ringing.decay_s /= all_j;
    return ringing;
  };
  const Ringing pane = ringing_of("window-pane", {0, 0, -0.1}), tile = ringing_of("ceramic-tile", {0, 0, -0.2});
  EXPECT_LT(pane.silent, 0.35);
  EXPECT_GT(tile.silent, 0.5);
  EXPECT_GT(pane.decay_s, 1.5 * tile.decay_s) << pane.decay_s << " " << tile.decay_s;
}

}  // namespace
}  // namespace ringdown::scene
