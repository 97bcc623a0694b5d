// A scene that was edited and saved is the scene that was edited: it loads, and it sounds the same.
#include "server/session/scene_save.h"

#include "engine/base/atomic_file.h"
#include "engine/modal/bank_file.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/scene_text.h"
#include "protocol/schema.h"
#include "server/session/offline.h"
#include "server/session/session.h"
#include "tests/scene/box_bank.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::session {
namespace {

namespace fs = std::filesystem;
using protocol::ObjectRef;

const fs::path kPresets = RINGDOWN_SOURCE_DIR "/presets";

class SceneSaveTest : public testing::Test {
 protected:
  SceneSaveTest() {
    for (const char* bank : {"a.glb", "b.glb"}) {
      EXPECT_TRUE(modal::write_bank(test::random_bank(bank[0], 40, 10), folder_ / bank));
    }
    std::ofstream(scene_) << R"(
[scene]
step_s = 0.002
duration_s = 2
[[object]]
name = "a"
bank = "a.glb"
[[static]]
name = "floor"
shape = "plane"
[[body]]
name = "one"
object = "a"
shape = "box"
size_m = [0.1, 0.2, 0.05]
density_kg_m3 = 2000
position_m = [0, 0, 0.4]
rotation = { axis = [1, 2, 3], degrees = 33 }
)";
  }

  void perform(const protocol::WorkerRequest& request) {
    const auto done = session_.perform(request, 0);
    ASSERT_TRUE(done) << done.error().message;
  }
  void play(const protocol::MixerRequest& request) { ASSERT_TRUE(session_.play(request, 0)); }
  static wire::ScoreEvent at(double time_s, const protocol::Request& request) {
    return {time_s, protocol::format(request)};
  }
  scene::SceneDescription read(const fs::path& path) {
    const auto scene = scene::read_scene(path, kPresets);
    EXPECT_TRUE(scene) << scene.error().message;
    return scene ? *scene : scene::SceneDescription();
  }
  Recording render(const fs::path& scene, std::vector<wire::ScoreEvent> score = {}) {
    auto recording =
        render_offline({.scene = scene, .score = std::move(score), .seconds = 2}, [](double) { return true; });
    EXPECT_TRUE(recording) << recording.error().message;
    if (!recording) return {};
    EXPECT_TRUE(recording->warnings.empty()) << recording->warnings[0];
    return std::move(*recording);
  }

  test::TemporaryFolder folder_;
  fs::path scene_ = folder_ / "scene.toml", saved_ = folder_ / "saved.toml";
  Session session_{48000};
};

TEST_F(SceneSaveTest, EditsAreInTheFileThatIsSaved) {
  perform(protocol::SceneLoad{scene_.string()});
  perform(protocol::LoadObject{"b", (folder_ / "b.glb").string()});
  perform(protocol::SetMaterial{{.name = "a"}, {0.5, 2, 3, 4, 1.5}});
  perform(protocol::SetGroup{{.name = "b"}, "metal"});
  play(protocol::SetGain{{.name = "a"}, {0.1, 0}});
  play(protocol::SetPan{{.name = "b"}, {-1.0 / 3}});
  const auto saved = save_scene(session_, saved_);
  ASSERT_TRUE(saved) << saved.error().message;

  const scene::SceneDescription scene = read(saved_);
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.objects[0].material, (modal::MaterialScale{0.5, 2, 3, 4, 1.5}));
  EXPECT_EQ(scene.objects[0].gain, 0.1);
  EXPECT_EQ(scene.objects[1].name, "b");
  EXPECT_EQ(scene.objects[1].bank, folder_ / "b.glb");
  EXPECT_EQ(scene.objects[1].group, "metal");
  EXPECT_EQ(scene.objects[1].pan, -1.0 / 3) << "to the last bit";
  ASSERT_EQ(scene.bodies.size(), 1u);
  EXPECT_EQ(scene.bodies[0].rotation, read(scene_).bodies[0].rotation) << "to the last bit";
  EXPECT_EQ(read_whole_file(saved_, 1 << 20)->find(folder_.path().string()), std::string::npos)
      << "the folder can be moved";

  Session again(48000);
  ASSERT_TRUE(again.perform(protocol::SceneLoad{saved_.string()}, 0));
  EXPECT_EQ(scene::to_toml(scene_of(again)), scene::to_toml(scene_of(session_)));
}

TEST_F(SceneSaveTest, WhatWasDroppedAndSetSoundsTheSameFromTheFile) {
  const double drop_s = 96 * 256 / 48000.0;  // between two blocks
  const protocol::SpawnBox box{ObjectRef{.name = "a"}, {0.05, 0, 0.5}, {0, 0, -1}, {0.1, 0.1, 0.1}, 2000};
  const protocol::SpawnSphere ball{std::nullopt, {0, 0.02, 0.8}, {}, 0.03, 7850};
  perform(protocol::SceneLoad{scene_.string()});
  play(protocol::SetGain{{.name = "a"}, {0.3, 0}});
  session_.scene().advance_to(static_cast<synth::Frame>(drop_s * 48000), std::nullopt);
  perform(box);
  perform(ball);
  ASSERT_TRUE(save_scene(session_, saved_));
  const auto bodies = read(saved_).bodies;
  ASSERT_EQ(bodies.size(), 3u);
  EXPECT_NEAR(bodies[1].start_s, drop_s, 0.01);

  const Recording live =
      render(scene_, {at(0.1, protocol::SetGain{{.name = "a"}, {0.3, 0}}), at(drop_s, box), at(drop_s, ball)});
  const Recording file = render(saved_);
  ASSERT_GT(live.peak, 1e-3F);
  // In the score the gain comes at 0.1 s, with a ramp, before anything has sounded.
  const auto differs = std::mismatch(live.left.begin(), live.left.end(), file.left.begin()).first - live.left.begin();
  EXPECT_EQ(static_cast<std::size_t>(differs), live.left.size()) << "bit for bit";
}

TEST_F(SceneSaveTest, BodiesThatWereClearedAreNotInTheFile) {
  perform(protocol::SceneLoad{scene_.string()});
  perform(protocol::SceneClear{});
  perform(protocol::SpawnSphere{std::nullopt, {0, 0, 1}, {}, 0.03, 7850});
  ASSERT_TRUE(save_scene(session_, saved_));
  const auto scene = read(saved_);
  ASSERT_EQ(scene.bodies.size(), 1u);
  EXPECT_EQ(scene.bodies[0].shape.type, scene::ShapeType::sphere);
  EXPECT_EQ(scene.statics.size(), 1u);
}

TEST_F(SceneSaveTest, BodiesThatWereTakenOutAreNotInTheFileUntilTheyComeBack) {
  perform(protocol::SceneLoad{scene_.string()});
  perform(protocol::SpawnSphere{std::nullopt, {0, 0, 1}, {}, 0.03, 7850});
  const auto names = [&] {
    EXPECT_TRUE(save_scene(session_, saved_));
    std::vector<std::string> found;
    for (const auto& body : read(saved_).bodies) found.push_back(body.name);
    std::ranges::sort(found);
    return found;
  };
  const auto both = names();
  ASSERT_EQ(both.size(), 2u);
  perform(protocol::SceneRemove{0});
  EXPECT_EQ(names(), std::vector<std::string>{both[1]});
  perform(protocol::SpawnSphere{std::nullopt, {0, 0, 2}, {}, 0.03, 7850});
  perform(protocol::SceneRestore{0});
  perform(protocol::SceneRemove{2});
  EXPECT_EQ(names(), both);
  EXPECT_FALSE(session_.perform(protocol::SceneRemove{7}, 0));
}

TEST_F(SceneSaveTest, BodiesThatWerePlacedBeginThereInTheFile) {
  perform(protocol::SceneLoad{scene_.string()});
  perform(protocol::SpawnSphere{std::nullopt, {0, 0, 1}, {1, 0, 0}, 0.03, 7850});
  const std::array poses = {Pose{{0.5, -2, 3}, Rotation::from_xyzw(1, 0, 0, 0)}, Pose{{4, 5, 6}, {}}};
  for (const std::int32_t body : {0, 1}) perform(protocol::ScenePlace{body, poses[static_cast<std::size_t>(body)]});
  ASSERT_TRUE(save_scene(session_, saved_));
  const auto bodies = read(saved_).bodies;
  ASSERT_EQ(bodies.size(), poses.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    EXPECT_EQ(bodies[i].position_m, poses[i].position_m) << bodies[i].name;
    EXPECT_EQ(bodies[i].rotation, poses[i].rotation) << bodies[i].name;
    EXPECT_EQ(bodies[i].velocity_m_s, Vec3{}) << bodies[i].name;
  }
}

// Without bodies the scene is not stepped, which would have ended what the floor does to the object.
TEST_F(SceneSaveTest, TheLastBodyThatIsTakenOutTouchesNothingAnyMore) {
  perform(protocol::SceneLoad{scene_.string()});
  session_.scene().advance_to(96000, std::nullopt);
  const auto dampers = [&] { return session_.rack().objects()[0]->dampers.size(); };
  ASSERT_GT(dampers(), 0u) << "the floor damps the body that rests on it";
  perform(protocol::SceneRemove{0});
  EXPECT_EQ(dampers(), 0u);
}

TEST_F(SceneSaveTest, ASceneThatIsLoadedPausedWaits) {
  perform(protocol::SceneLoad{scene_.string(), true});
  session_.scene().advance_to(48000, std::nullopt);
  EXPECT_EQ(session_.scene().poses().time_s, 0);
  perform(protocol::ScenePause{false});
  session_.scene().advance_to(96000, std::nullopt);
  EXPECT_GT(session_.scene().poses().time_s, 0.9);
}

TEST_F(SceneSaveTest, ObjectsWithoutASceneMakeASceneAndNothingMakesNone) {
  const auto nothing = save_scene(session_, saved_);
  ASSERT_FALSE(nothing);
  EXPECT_NE(nothing.error().message.find("nothing to save"), std::string::npos);
  EXPECT_FALSE(fs::exists(saved_));
  perform(protocol::LoadObject{"b", (folder_ / "b.glb").string()});
  ASSERT_TRUE(save_scene(session_, saved_));
  EXPECT_EQ(read(saved_).objects.size(), 1u);
}

TEST_F(SceneSaveTest, ASecondBodyOfANameGetsAnother) {
  perform(protocol::SceneLoad{scene_.string()});
  for (int i = 0; i < 3; ++i) perform(protocol::SpawnSphere{std::nullopt, {0, 0, 1.0 + i}, {}, 0.03, 7850});
  ASSERT_TRUE(save_scene(session_, saved_));
  perform(protocol::SceneLoad{saved_.string()});
  perform(protocol::SpawnSphere{std::nullopt, {0, 0, 9}, {}, 0.03, 7850});
  ASSERT_TRUE(save_scene(session_, folder_ / "again.toml"));
  EXPECT_EQ(read(folder_ / "again.toml").bodies.size(), 5u);
}

// Every scene that comes with Ringdown, so every key that scenes use.
TEST(SceneText, EveryPresetComesBackAsItWas) {
  std::size_t scenes = 0;
  for (const auto& entry : fs::directory_iterator(kPresets / "scenes")) {
    if (entry.path().extension() != ".toml") continue;
    const auto scene = scene::read_scene(entry.path(), kPresets);
    ASSERT_TRUE(scene) << scene.error().message;
    const auto again = scene::parse_scene(to_toml(*scene), entry.path(), kPresets);
    ASSERT_TRUE(again) << again.error().message << "\n" << to_toml(*scene);
    EXPECT_EQ(to_toml(*again), to_toml(*scene));
    ++scenes;
  }
  EXPECT_GT(scenes, 5u);
}

TEST(SceneText, APresetPlaysBitForBitWhatItsTextPlays) {
  const test::TemporaryFolder folder;
  for (const char* name : {"chimes.toml", "demo.toml"}) {
    const auto scene = scene::read_scene(kPresets / "scenes" / name, kPresets);
    ASSERT_TRUE(scene) << scene.error().message;
    std::ofstream(folder / name) << to_toml(*scene);
    Recording played[2];
    for (const auto& [path, to] : {std::pair(kPresets / "scenes" / name, &played[0]), {folder / name, &played[1]}}) {
      auto rendered = render_offline({.scene = path, .seconds = 1.5}, [](double) { return true; });
      ASSERT_TRUE(rendered) << rendered.error().message;
      *to = std::move(*rendered);
    }
    EXPECT_GT(played[0].peak, 1e-4F) << name;
    EXPECT_EQ(played[0].left, played[1].left) << name;
    EXPECT_EQ(played[0].right, played[1].right) << name;
  }
}

}  // namespace
}  // namespace ringdown::session
