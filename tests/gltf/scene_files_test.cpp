// Scenes that Ringdown writes before programs of others: the drafts' rules, the public validator, and Babylon.js.
#include "engine/gltf/glb.h"
#include "engine/modal/bank_file.h"
#include "engine/scene/scene_file.h"
#include "tests/integration/process.h"
#include "tests/scene/gltf_room.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <sstream>

namespace ringdown::test {
namespace {

namespace fs = std::filesystem;
using modal::Json;

const fs::path kSource = RINGDOWN_SOURCE_DIR;
const fs::path kPresets = kSource / "presets";
constexpr int kCannotBeFetched = 77;

class SceneFiles : public testing::Test {
 protected:
  void SetUp() override {
    if (!installed("node")) GTEST_SKIP() << "nodejs is not installed, which reads the scenes";
  }

  fs::path exported(const std::string& scene) {
    const fs::path file = folder_ / (scene + ".glb");
    const Outcome outcome = run({RINGDOWN_BIN_DIR "/ringdown", "scene", "export", scene, "-o", file});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return file;
  }

  static Outcome node(const std::string& script, std::vector<std::string> words) {
    words.insert(words.begin(), {"node", kSource / "tests/gltf" / script});
    return run(words, {}, std::chrono::seconds(120));
  }

  // Fetches packages from npm, or says why the test is skipped.
  static std::string fetch(std::vector<std::string> more) {
    std::vector<std::string> words{kSource / "tests/gltf/fetch_packages.sh", RINGDOWN_NPM_FOLDER};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome fetched = run(words, {}, std::chrono::seconds(120));
    EXPECT_TRUE(fetched.exit_code == 0 || fetched.exit_code == kCannotBeFetched) << fetched.output;
    return fetched.exit_code == 0 ? "" : fetched.output;
  }

  TemporaryFolder folder_;
};

TEST_F(SceneFiles, EveryPresetSceneKeepsTheDraftsRules) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(kPresets / "scenes")) {
    if (entry.path().extension() == ".toml") files.push_back(exported(entry.path().stem().string()));
  }
  ASSERT_GT(files.size(), 5u);
  const Outcome checked = node("check_scene.js", files);
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
  if (const std::string why = fetch({}); !why.empty()) {
    std::printf("without the public validator: %s\n", why.c_str());
    return;
  }
  std::vector<std::string> words{RINGDOWN_NPM_FOLDER "/gltf-validator"};
  words.insert(words.end(), files.begin(), files.end());
  const Outcome valid = node("validate.js", words);
  EXPECT_EQ(valid.exit_code, 0) << valid.output;
}

TEST_F(SceneFiles, TheRulesFindWhatBreaksThem) {
  test::GltfRoom good;
  good.add("KHR_implicit_shapes", "shapes", {{"type", "box"}, {"box", {{"size", {1, 1, 1}}}}});
  good.add("KHR_physics_rigid_bodies", "physicsMaterials", {{"staticFriction", 0.5}});
  good.add("KHR_audio_rigid_bodies", "acousticSurfaces", {{"roughness", 1e-6}});
  Json node;
  node["extensions"]["KHR_physics_rigid_bodies"] = {
      {"motion", {{"mass", 1}}}, {"collider", {{"geometry", {{"shape", 0}}}, {"physicsMaterial", 0}}}};
  node["extensions"]["KHR_audio_rigid_bodies"] = {{"acousticSurface", 0}};
  good.add_node(node);
  const auto faults = [&](const std::function<void(Json&)>& change) {
    test::GltfRoom room = good;
    change(room.json);
    return SceneFiles::node("check_scene.js", {folder_.write("room.glb", room.glb())});
  };
  const Outcome whole = faults([](Json&) {});
  EXPECT_EQ(whole.exit_code, 0) << whole.output;
  const auto physics = [](Json& json) -> Json& { return json["nodes"][0]["extensions"]["KHR_physics_rigid_bodies"]; };
  const std::pair<const char*, std::function<void(Json&)>> cases[] = {
      {"motion.mass", [&](Json& json) { physics(json)["motion"]["mass"] = -1; }},
      {"motion.weight", [&](Json& json) { physics(json)["motion"]["weight"] = 1; }},
      {"lacks geometry", [&](Json& json) { physics(json)["collider"].erase("geometry"); }},
      {"names nothing", [&](Json& json) { physics(json)["collider"]["physicsMaterial"] = 1; }},
      {"inertiaOrientation",
       [&](Json& json) {
         physics(json)["motion"]["inertiaOrientation"] = {1, 1, 0, 0};
       }},
      {"roughness",
       [](Json& json) { json["extensions"]["KHR_audio_rigid_bodies"]["acousticSurfaces"][0]["roughness"] = "fine"; }},
      {"lacks box", [](Json& json) { json["extensions"]["KHR_implicit_shapes"]["shapes"][0].erase("box"); }},
      {"does not say that it uses", [](Json& json) { json["extensionsUsed"].erase(0); }},
  };
  for (const auto& [what, change] : cases) {
    const Outcome broken = faults(change);
    EXPECT_EQ(broken.exit_code, 1) << what;
    EXPECT_NE(broken.output.find(what), std::string::npos) << what << "\n" << broken.output;
  }
}

TEST_F(SceneFiles, BabylonFindsEveryBodyInItsPlaceWithItsTriangles) {
  if (const std::string why = fetch({"babylon"}); !why.empty()) GTEST_SKIP() << why;
  struct Found {
    Vec3 place_m;
    std::size_t triangles = 0;
  };
  for (const std::string name : {"demo", "bell-and-clapper"}) {
    const Outcome loaded = node("load_babylon.mjs", {RINGDOWN_NPM_FOLDER, exported(name)});
    ASSERT_EQ(loaded.exit_code, 0) << loaded.output;
    std::map<std::string, Found> found;
    std::istringstream lines(loaded.output);
    std::string word;
    for (Found node; lines >> word >> node.place_m.x >> node.place_m.y >> node.place_m.z >> node.triangles;)
      found[word] = node;
    const auto scene = scene::read_scene(kPresets / ("scenes/" + name + ".toml"), kPresets);
    ASSERT_TRUE(scene) << scene.error().message;
    ASSERT_GT(scene->bodies.size(), 1);
    for (const scene::BodyDescription& body : scene->bodies) {
      ASSERT_TRUE(found.contains(body.name)) << body.name << "\n" << loaded.output;
      const auto [place_m, triangles] = found[body.name];
      // y of the file is our z, and z of the file our -y; Babylon's numbers are floats.
      const Vec3 expected_m{body.position_m.x, body.position_m.z, -body.position_m.y};
      EXPECT_LT(length(place_m - expected_m), 1e-6) << body.name;
      if (body.object.empty()) continue;
      const auto object = std::ranges::find(scene->objects, body.object, &scene::ObjectDescription::name);
      EXPECT_EQ(triangles, modal::read_bank(object->bank).value().triangles.size()) << body.name;
    }
  }
}

}  // namespace
}  // namespace ringdown::test
