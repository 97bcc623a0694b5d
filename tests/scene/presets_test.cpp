// Every scene in presets/scenes plays: it reads, builds, and its objects are heard.
#include "engine/modal/bank_file.h"
#include "engine/scene/scene_file.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>

namespace ringdown::scene {
namespace {

const std::filesystem::path kPresets = std::filesystem::path(RINGDOWN_SOURCE_DIR) / "presets";

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kPresets / "scenes")) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

class PresetScene : public testing::TestWithParam<std::string> {};

TEST_P(PresetScene, EveryObjectIsHeardAndNothingIsLost) {
  const auto scene = read_scene(kPresets / "scenes" / (GetParam() + ".toml"), kPresets);
  ASSERT_TRUE(scene) << scene.error().message;
  std::vector<SoundingObject> objects;
  for (const ObjectDescription& object : scene->objects) {
    auto bank = modal::read_bank(object.bank);
    ASSERT_TRUE(bank) << bank.error().message;
    objects.push_back(test::sounding(object.name, static_cast<std::uint32_t>(objects.size()), std::move(*bank)));
  }
  auto world = World::create(*scene, objects, 48000);
  ASSERT_TRUE(world) << world.error().message;

  std::map<protocol::ObjectNumber, int> heard;
  std::map<protocol::ObjectNumber, double> first_s;
  while (world->time_s() < scene->duration_s) {
    const StepReport report = world->step();
    EXPECT_EQ(report.dropped_strikes + report.dropped_contacts, 0u);
    for (const std::string& notice : report.notices) ADD_FAILURE() << notice;
    for (const protocol::Event& strike : report.strikes) {
      if (strike.type != protocol::EventType::strike) continue;
      first_s.try_emplace(strike.object, static_cast<double>(strike.frame) / 48000);
      ++heard[strike.object];
    }
  }
  for (const SoundingObject& object : objects) {
    EXPECT_GT(heard[object.number], 0) << object.name;
    std::printf("%-16s first at %6.3f s, %4d strikes\n", object.name.c_str(), first_s[object.number],
                heard[object.number]);
  }
  for (const BodyState& body : world->bodies()) {
    EXPECT_LT(length(body.velocity_m_s), 0.1) << body.name << " still moves at the end";
  }
}

INSTANTIATE_TEST_SUITE_P(Presets, PresetScene, testing::ValuesIn(scene_names()), [](const auto& test) {
  std::string name = test.param;
  std::ranges::replace(name, '-', '_');
  return name;
});
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(PresetScene);

}  // namespace
}  // namespace ringdown::scene
