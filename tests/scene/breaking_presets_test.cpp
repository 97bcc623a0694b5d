// Glasses fall onto stone. Strengths are those of the material's sources, drawn for twenty seeds; orientation and
// height decide.
#include "engine/breaking/piece_set.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/fracture/fracture.h"
#include "engine/modal/strike_map.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
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

// Returns how many of twenty bodies, turned by `degrees` about the y axis, break within `seconds` after they have
// fallen onto granite from this height. Each has a strength of its own.
std::size_t broken_of_twenty(const Preset& preset, double degrees, double height_m, double seconds) {
  std::vector<BodyDescription> bodies;
  std::vector<SoundingObject> objects;
  for (std::size_t i = 0; i < kSeeds; ++i) {
    const std::string name = "glass" + std::to_string(i);
    objects.push_back({name, static_cast<synth::ObjectNumber>(i), preset.bank, preset.map, preset.pieces});
    BodyDescription body = test::body_of(name, ShapeType::convex, {});
    body.rotation = about({0, 1, 0}, degrees * std::numbers::pi / 180);
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
  std::size_t broken = 0;
  while (world.time_s() < seconds && broken < kSeeds) {
    for (const std::string& notice : world.step().notices) broken += notice.find("broke into") != std::string::npos;
  }
  return broken;
}

TEST(BreakingPresets, AGlassBreaksFromATableAndNotFromAHandsBreadth) {
  const Preset tumbler("tumbler");
  for (const double degrees : {90.0, 140.0}) {  // on its side, on its rim
    EXPECT_GE(broken_of_twenty(tumbler, degrees, 0.75, 0.05), 18u) << degrees;
    EXPECT_EQ(broken_of_twenty(tumbler, degrees, 0.05, 0.3), 0u) << degrees;
  }
  EXPECT_EQ(broken_of_twenty(tumbler, 0, 0.05, 0.1), 0u) << "on its base";
}

}  // namespace
}  // namespace ringdown::scene
