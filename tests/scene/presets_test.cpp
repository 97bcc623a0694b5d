// Every scene in presets/scenes plays: it reads, builds, its objects are heard, and it goes the same way each time.
#include "engine/modal/bank_file.h"
#include "engine/scene/gltf/scene.h"
#include "engine/scene/gltf/writer.h"
#include "engine/scene/scene_file.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <tuple>
#include <utility>

namespace ringdown::scene::presets_test {
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

class PresetScene : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    auto scene = read_scene(kPresets / "scenes" / (GetParam() + ".toml"), kPresets);
    ASSERT_TRUE(scene) << scene.error().message;
    scene_ = std::move(*scene);
    for (const ObjectDescription& object : scene_.objects) {
      auto bank = modal::read_bank(object.bank);
      ASSERT_TRUE(bank) << bank.error().message;
      objects_.push_back(test::sounding(object.name, static_cast<std::uint32_t>(objects_.size()), std::move(*bank)));
    }
  }

  [[nodiscard]] Result<World> build() const { return World::create(scene_, objects_, 48000); }

  [[nodiscard]] bool hangs(const std::string& body) const {
    return std::ranges::any_of(scene_.joints,
                               [&](const JointDescription& j) { return j.body == body || j.other == body; });
  }

  [[nodiscard]] bool breaks() const {
    return std::ranges::any_of(scene_.bodies, [](const BodyDescription& body) { return body.breaks.has_value(); });
  }

  SceneDescription scene_;
  std::vector<SoundingObject> objects_;
};

TEST_P(PresetScene, EveryObjectOfAPresetSceneIsHeardAndNothingIsLost) {
  auto world = build();
  ASSERT_TRUE(world) << world.error().message;

  std::map<synth::ObjectNumber, int> heard;
  std::map<synth::ObjectNumber, double> first_s;
  while (world->time_s() < scene_.duration_s) {
    const StepReport report = world->step();
    EXPECT_EQ(report.dropped_events + report.dropped_contacts, 0u);
    for (const std::string& notice : report.notices) {
      if (notice.find(" broke into ") == std::string::npos) ADD_FAILURE() << notice;
    }
    for (const synth::Event& strike : report.events) {
      // The blow that breaks a body ends the sound of the whole.
      if (!excites(strike) && !strike.verb.holds<synth::verb::Collision>() && !strike.verb.holds<synth::verb::Rub>() &&
          !strike.verb.holds<synth::verb::Choke>()) {
        continue;
      }
      first_s.try_emplace(strike.object, static_cast<double>(strike.frame) / 48000);
      ++heard[strike.object];
    }
  }
  for (const SoundingObject& object : objects_) {
    EXPECT_GT(heard[object.number], 0) << object.name;
    std::printf("%-16s first at %6.3f s, %4d strikes and touches\n", object.name.c_str(), first_s[object.number],
                heard[object.number]);
  }
  for (const BodyState& body : world->bodies()) {
    if (hangs(body.name) || breaks()) continue;  // they may swing on, and shards rock for long
    EXPECT_LT(length(body.velocity_m_s), 0.1) << body.name << " still moves at the end";
  }
}

// Two worlds step by turns, so that what one leaves behind in the process reaches the other at another time.
TEST_P(PresetScene, TwoWorldsOfAPresetSceneAgreeBitForBit) {
  auto one = build(), other = build();
  ASSERT_TRUE(one && other);
  constexpr double kMaxTime_s = 4;  // the first strikes of each are over by then
  while (one->time_s() < std::min(scene_.duration_s, kMaxTime_s)) {
    const StepReport first = one->step(), second = other->step();
    ASSERT_TRUE(std::ranges::equal(first.events, second.events, test::same_bits)) << "at " << one->time_s() << " s";
  }
  const std::vector<BodyState> ended = one->bodies(), also = other->bodies();
  ASSERT_EQ(ended.size(), also.size());
  for (std::size_t i = 0; i < ended.size(); ++i) {
    EXPECT_TRUE(ended[i].center_m == also[i].center_m && ended[i].rotation == also[i].rotation) << ended[i].name;
  }
}

// What `ringdown scene export` writes is read again, with the banks inside it, and plays the events of the scene.
TEST_P(PresetScene, ExportedPresetScenesPlayTheSameEvents) {
  if (breaks()) GTEST_SKIP() << "exported scenes have no pieces, so their bodies stay whole";
  std::vector<modal::Bank> banks;
  for (const ObjectDescription& object : scene_.objects) banks.push_back(modal::read_bank(object.bank).value());
  const auto bytes = to_glb(scene_, banks);
  ASSERT_TRUE(bytes) << bytes.error().message;
  const auto read = parse_gltf_scene(*bytes, "scene.glb", {});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->notes.empty());
  std::vector<SoundingObject> objects;
  for (const ObjectDescription& object : read->scene.objects) {
    auto bank = modal::parse_bank(*bytes, object.bank.string(), modal::split_bank_path(object.bank).model);
    ASSERT_TRUE(bank) << bank.error().message;
    objects.push_back(test::sounding(object.name, static_cast<std::uint32_t>(objects.size()), std::move(*bank)));
  }
  auto before = build(), after = World::create(read->scene, objects, 48000);
  ASSERT_TRUE(before) << before.error().message;
  ASSERT_TRUE(after) << after.error().message;
  std::size_t events = 0;
  constexpr double kMaxTime_s = 4;
  while (before->time_s() < std::min(scene_.duration_s, kMaxTime_s)) {
    const StepReport first = before->step(), second = after->step();
    ASSERT_TRUE(std::ranges::equal(first.events, second.events, test::same_bits)) << "at " << before->time_s() << " s";
    events += first.events.size();
  }
  EXPECT_GT(events, 0u);
}

TEST(PresetScenes, PresetScenesLastFromSixToTwelveSeconds) {
  EXPECT_GE(scene_names().size(), 8u);
  for (const std::string& name : scene_names()) {
    const auto scene = read_scene(kPresets / "scenes" / (name + ".toml"), kPresets);
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_GE(scene->duration_s, 6) << name;
    EXPECT_LE(scene->duration_s, 12) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Presets, PresetScene, testing::ValuesIn(scene_names()), [](const auto& test) {
  std::string name = test.param;
  std::ranges::replace(name, '-', '_');
  return name;
});
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(PresetScene);

// A body lies where its mesh lies: hulls and meshes collide at the points of the bank, wherever the centre of mass is
// in their bounding box.
class RestingPreset : public testing::TestWithParam<std::tuple<std::string, ShapeType>> {};

TEST_P(RestingPreset, ABodyLiesOnTheFloorWithItsMeshAndNotBesideIt) {
  const auto& [name, shape] = GetParam();
  auto bank = modal::read_bank(kPresets / "banks" / (name + ".glb"));
  ASSERT_TRUE(bank) << bank.error().message;
  const std::vector<modal::Vec3f> points = bank->positions;
  SceneDescription scene;
  scene.objects = {{.name = name, .bank = "x"}};
  BodyDescription body{.name = name, .object = name, .shape = {.type = shape}, .position_m = {0, 0, 0.3}};
  body.surface.restitution = 0;
  scene.bodies = {body};
  scene.statics = {{.name = "floor"}};
  auto world = World::create(scene, std::array{test::sounding(name, 0, std::move(*bank))}, 48000);
  ASSERT_TRUE(world) << world.error().message;
  while (world->time_s() < 3) world->step();
  const BodyState state = world->bodies()[0];
  double lowest = 1;
  for (const auto& [x, y, z] : points) {
    lowest = std::min(lowest, state.position_m.z + rotated(state.rotation, Vec3{x, y, z}).z);
  }
  EXPECT_NEAR(lowest, 0, 0.001);
}

INSTANTIATE_TEST_SUITE_P(Of, RestingPreset,
                         testing::Combine(testing::Values("frying-pan", "knife", "bronze-bell"),
                                          testing::Values(ShapeType::convex, ShapeType::trimesh)),
                         [](const auto& one) {
                           std::string name = std::get<0>(one.param);
                           std::ranges::replace(name, '-', '_');
                           return name + (std::get<1>(one.param) == ShapeType::convex ? "_hull" : "_mesh");
                         });

}  // namespace
}  // namespace ringdown::scene::presets_test
