// The embedded scene as the daemon runs it: what it sends when it ends, and when it need not run.
#include "engine/modal/bank_file.h"
#include "server/session/scene_save.h"
#include "server/session/session.h"
#include "tests/scene/box_bank.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <thread>
#include <vector>

namespace ringdown::session {
namespace {

using synth::Event;

// A box that slides over a floor for seconds.
const std::string kSlider = R"(
[[static]]
name = "floor"
shape = "plane"
friction = 0.01
[[body]]
name = "box"
size_m = [0.1, 0.1, 0.1]
density_kg_m3 = 1000
friction = 0.01
restitution = 0
position_m = [0, 0, 0.05]
velocity_m_s = [2, 0, 0]
)";
const std::string kObject = "object = \"bell\"\n[[object]]\nname = \"bell\"\nbank = \"a.glb\"\n";

class ScenePlayerTest : public testing::Test {
 protected:
  ScenePlayerTest() {
    EXPECT_TRUE(modal::write_bank(test::single_mode_bank(440, 2), folder_ / "a.glb"));
    session_.scene().send_to([this](const scene::StepReport& report) {
      for (const Event& event : report.events) take(event);
      return std::size_t{0};
    });
  }

  void take(const Event& event) {
    const auto* told = event.verb.get_if<synth::verb::Contact>();
    if (!told) return;
    if (told->contact.force_n == Vec3{}) {
      going_on_.erase(told->contact.number);
      ++ends_;
    } else {
      going_on_[told->contact.number] = event;
    }
  }

  void load(const std::string& scene) {
    std::ofstream(folder_ / "scene.toml") << scene;
    const auto loaded = session_.scene().load(folder_ / "scene.toml", now_);
    ASSERT_TRUE(loaded) << loaded.error().message;
  }

  void play(double seconds) {
    now_ += static_cast<synth::Frame>(48000 * seconds);
    session_.scene().advance_to(now_, 48000);
  }

  double place() { return session_.scene().poses().bodies.at(0).position_m.x; }

  test::TemporaryFolder folder_;
  Session session_{48000};
  synth::Frame now_ = 0;
  std::map<std::uint32_t, Event> going_on_;
  int ends_ = 0;
};

// Two nodes with the bank as their model, one of them in twice the size, above a plane; `more` are members of a node.
void write_gltf_scene(const std::filesystem::path& bank, const std::filesystem::path& path,
                      const std::string& more = "") {
  std::ifstream file(bank, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  std::uint32_t size = 0;
  std::memcpy(&size, bytes.data() + 12, 4);
  nlohmann::json json = nlohmann::json::parse(bytes.substr(20, size));
  std::ofstream(path.parent_path() / "scene.bin", std::ios::binary) << bytes.substr(28 + size);
  json["buffers"][0]["uri"] = "scene.bin";
  const auto bell = [](const std::string& placed) {
    return R"({"name": "bell", "extensions": {"KHR_audio_rigid_bodies": {"modalModel": 0, "gain": 0.5},
      "KHR_physics_rigid_bodies": {"motion": {"mass": 1}, "collider": {"geometry": {"shape": 0}}}}, )" +
           placed + "}";
  };
  json["nodes"] = nlohmann::json::parse(
      "[" + bell(R"("translation": [0, 0.3, 0])") + "," + bell(R"("translation": [1, 0.4, 0], "scale": [2, 2, 2])") +
      R"(, {"extensions": {"KHR_physics_rigid_bodies": {)" + more + R"("collider": {"geometry": {"shape": 1}}}}}])");
  json["scenes"] = nlohmann::json::parse(R"([{"nodes": [0, 1, 2]}])");
  json["extensions"]["KHR_implicit_shapes"] = nlohmann::json::parse(
      R"({"shapes": [{"type": "sphere", "sphere": {"radius": 0.1}}, {"type": "plane", "plane": {}}]})");
  std::ofstream(path) << json.dump();
}

// The body stands on the floor. A collider of twice the size would lift it to 0.1 m.
TEST_F(ScenePlayerTest, ABodyKeepsTheSizeOfItsContactsWhenItsObjectGetsAnother) {
  ASSERT_TRUE(modal::write_bank(test::box_bank({0.1, 0.1, 0.1}, 1), folder_ / "a.glb"));
  load(
      "[[static]]\nname = \"floor\"\nshape = \"plane\"\n"
      "[[body]]\nname = \"bell\"\nshape = \"convex\"\nposition_m = [0, 0, 0.05]\n" +
      kObject);
  const auto height_m = [&] { return session_.scene().poses().bodies.at(0).position_m.z; };
  play(0.5);
  ASSERT_NEAR(height_m(), 0.05, 1e-3);
  ASSERT_TRUE(session_.perform(protocol::SetMaterial{{.name = "bell"}, {.size = 2}}, now_));
  play(1);
  EXPECT_NEAR(height_m(), 0.05, 1e-3);
  ASSERT_TRUE(session_.perform(protocol::SceneRemove{0}, now_));
  ASSERT_TRUE(session_.perform(protocol::SceneRestore{0}, now_));
  play(1);
  EXPECT_NEAR(height_m(), 0.05, 1e-3) << "also when it comes back";
}

TEST_F(ScenePlayerTest, AGltfSceneHasAnObjectForEachNodeAndNamesWhatItLeavesOut) {
  write_gltf_scene(folder_ / "a.glb", folder_ / "room.gltf", R"("trigger": {}, )");
  std::vector<std::string> warnings;
  std::map<synth::ObjectNumber, int> strikes;
  Session session(48000);
  session.rack().warn = [&](const std::string& sentence) { warnings.push_back(sentence); };
  session.scene().send_to([&](const scene::StepReport& report) {
    for (const Event& event : report.events) strikes[event.object] += event.verb.holds<synth::verb::Strike>();
    return std::size_t{0};
  });
  const auto loaded = session.scene().load(folder_ / "room.gltf", 0);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(
      warnings,
      std::vector<std::string>{
          "scene: triggers have no effect: nothing collides with them, and bodies that enter them are not reported"});
  const auto small = session.rack().find({.name = "bell"}), large = session.rack().find({.name = "bell-2"});
  ASSERT_TRUE(small && large);
  // Under a scale the points lie farther out, and the model rings as it does in the file.
  const modal::Bank &bank = (*small)->map->bank(), &larger = (*large)->map->bank();
  EXPECT_EQ(larger.frequency_hz, bank.frequency_hz);
  EXPECT_EQ(larger.shapes, bank.shapes);
  EXPECT_EQ(larger.positions.at(0)[0], 2 * bank.positions.at(0)[0]);
  EXPECT_EQ((*small)->gain, 0.5);
  EXPECT_EQ((*large)->material, modal::MaterialScale{});
  // Who shows the objects gets each bank alone, wherever the scene's buffers are.
  for (const auto& object : {*small, *large}) {
    ASSERT_TRUE(object->bank_alone);
    const auto shown = modal::parse_bank(*object->bank_alone, "alone");
    ASSERT_TRUE(shown) << shown.error().message;
    EXPECT_EQ(shown->positions, object->map->bank().positions);
    EXPECT_EQ(object->bank_bytes, object->bank_alone->size());
  }
  // As a TOML scene it names the models in the file.
  const auto saved = save_scene(session, folder_ / "saved.toml");
  ASSERT_TRUE(saved) << saved.error().message;
  const auto again = session_.scene().load(folder_ / "saved.toml", 0);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ((*session_.rack().find({.name = "bell-2"}))->bank, folder_ / "room.gltf#0@2.0");
  session.scene().advance_to(48000, 48000);
  EXPECT_GT(strikes[(*small)->number], 0);
  EXPECT_GT(strikes[(*large)->number], 0);
}

TEST_F(ScenePlayerTest, AGltfScenesOtherFilesLieBelowTheRootsToo) {
  write_gltf_scene(folder_ / "a.glb", folder_ / "room.gltf");
  std::filesystem::remove(folder_ / "scene.bin");
  const test::TemporaryFolder elsewhere;
  std::ofstream(elsewhere / "secret.bin") << std::string(100000, 'x');
  std::filesystem::create_symlink(elsewhere / "secret.bin", folder_ / "scene.bin");
  EXPECT_TRUE(session_.roots().read(folder_ / "room.gltf", 1 << 20));
  Session guarded(48000, *FileRoots::only({folder_.path()}));
  const auto loaded = guarded.scene().load(folder_ / "room.gltf", 0);
  ASSERT_FALSE(loaded);
  EXPECT_NE(loaded.error().message.find("scene.bin"), std::string::npos) << loaded.error().message;
  EXPECT_FALSE(guarded.scene().playing());
}

TEST_F(ScenePlayerTest, ASceneThatCannotKeepUpLosesTimeAndSaysHowMuch) {
  load(kSlider + kObject);
  play(0.5);
  EXPECT_EQ(session_.scene().lost().slowed_s, 0);
  const double before = place();
  play(5);  // at once: all but the second of slack is lost
  EXPECT_NEAR(session_.scene().lost().slowed_s, 4, 0.05);
  EXPECT_NEAR(place(), before + 2 * 1, 0.1);
}

// An hour of steps is to be caught up with; the request has its turn after one of them.
TEST_F(ScenePlayerTest, ARequestWaitsForOneStepAndNotForAllThatAreToBeCaughtUpWith) {
  constexpr double kHour_s = 3600;
  load(kSlider + kObject);
  std::jthread scene([this] { session_.scene().advance_to(static_cast<synth::Frame>(48000 * kHour_s), std::nullopt); });
  while (session_.scene().poses().time_s == 0) std::this_thread::yield();
  ASSERT_TRUE(session_.scene().clear());
  scene.join();
  EXPECT_LT(session_.scene().poses().time_s, 0.9 * kHour_s);
}

TEST_F(ScenePlayerTest, ClearingASceneEndsTheContactsThatGoOn) {
  load(kSlider + kObject);
  play(0.2);
  ASSERT_EQ(going_on_.size(), 1u);
  ASSERT_TRUE(session_.scene().clear());
  EXPECT_TRUE(going_on_.empty());
  EXPECT_EQ(ends_, 1);
}

TEST_F(ScenePlayerTest, ClearingAPausedSceneEndsItsContactsToo) {
  load(kSlider + kObject);
  play(0.2);
  ASSERT_TRUE(session_.scene().pause(true));
  ASSERT_TRUE(session_.scene().clear());
  EXPECT_TRUE(going_on_.empty());
}

TEST_F(ScenePlayerTest, AnotherSceneEndsTheContactsOfTheOneBefore) {
  load(kSlider + kObject);
  play(0.2);
  ASSERT_EQ(going_on_.size(), 1u);
  load(kSlider);
  EXPECT_TRUE(going_on_.empty());
}

TEST_F(ScenePlayerTest, TheLastBodyThatLeavesEndsItsContacts) {
  std::string scene = kSlider + kObject;
  scene.replace(scene.find("[0, 0, 0.05]"), 12, "[999.8, 0, 0.05]");
  load(scene);
  play(0.05);
  ASSERT_EQ(going_on_.size(), 1u);
  play(0.3);
  EXPECT_EQ(session_.scene().body_count(), 0u);
  EXPECT_TRUE(going_on_.empty());
}

TEST_F(ScenePlayerTest, ASceneThatCannotSoundWaitsUntilItCanOrIsWatched) {
  load(kSlider);
  play(0.5);
  EXPECT_EQ(place(), 0);
  session_.scene().set_watched(true);
  play(0.5);
  const double seen = place();
  EXPECT_NEAR(seen, 1, 0.05);
  session_.scene().set_watched(false);
  play(0.5);
  EXPECT_EQ(place(), seen);
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"bell", (folder_ / "a.glb").string()}, now_));
  protocol::SpawnSphere ball;
  ball.object = protocol::ObjectRef{"bell", {}};
  ball.radius_m = 0.02;
  ball.density_kg_m3 = 2500;
  ball.position_m = {0, 5, 1};
  const auto spawned = session_.scene().spawn(ball);
  ASSERT_TRUE(spawned) << spawned.error().message;
  play(0.5);
  EXPECT_NEAR(place(), seen + 1, 0.07);
}

}  // namespace
}  // namespace ringdown::session
