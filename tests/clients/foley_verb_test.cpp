// The commands of docs/use/film.md turn a scene or a file of meshes into the sound of an animation.
#include "engine/modal/bank_file.h"
#include "tests/integration/process.h"
#include "tests/scene/gltf_room.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace ringdown::test {
namespace {

namespace fs = std::filesystem;

constexpr int kBadInput = 3, kUsage = 2, kSilence = 7;  // docs/reference/settings.md

class FoleyVerb : public testing::Test {
 protected:
  Outcome ringdown(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), RINGDOWN_BIN_DIR "/ringdown");
    return run(arguments);
  }

  // How many lines of a report contain a word.
  static std::size_t count(const fs::path& report, const std::string& word) {
    std::ifstream file(report);
    std::size_t found = 0;
    for (std::string line; std::getline(file, line);) found += line.find(word) == std::string::npos ? 0 : 1;
    return found;
  }

  // A cube, made of what its material's name says, that falls on a fixed one of another material.
  fs::path write_fall(const std::string& material, const std::string& of_floor) {
    GltfRoom room;
    room.json.erase("extensionsUsed");
    const std::size_t floor = room.add_box("floor", {0.3, 0.06, 0.3}), cube = room.add_box("cube", {0.06, 0.06, 0.06});
    room.json["materials"] = {{{"name", of_floor}}, {{"name", material}}};
    room.json["meshes"][floor]["primitives"][0]["material"] = 0;
    room.json["meshes"][cube]["primitives"][0]["material"] = 1;
    room.add_node({{"name", "Floor"}, {"mesh", floor}, {"translation", {0, -0.03, 0}}});
    const std::size_t node = room.add_node({{"name", "Cube"}, {"mesh", cube}});
    std::vector<float> times, places;
    const double landing_s = std::sqrt(2 * 0.3 / 9.81);
    for (int k = 0; k <= 18; ++k) {
      const double t = k / 30.0, since = t - landing_s;
      const double y =
          since < 0 ? 0.3 - 0.5 * 9.81 * t * t : 0.5 * 9.81 * landing_s * since - 0.5 * 9.81 * since * since;
      times.push_back(static_cast<float>(t));
      places.insert(places.end(), {0, static_cast<float>(0.03 + y), 0});
    }
    room.json["animations"] = {{{"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", "translation"}}}}}},
                                {"samplers",
                                 {{{"input", room.add_array(times, 5126, "SCALAR", 1)},
                                   {"output", room.add_array(places, 5126, "VEC3", 3)}}}}}};
    return folder_.write("fall.glb", room.glb());
  }

  TemporaryFolder folder_;
};

TEST_F(FoleyVerb, ASimulatedSceneIsHeardByItsKeyframes) {
  const std::string glb = folder_ / "rain.glb", wav = folder_ / "rain.wav", report = folder_ / "rain.csv";
  const Outcome exported = ringdown({"scene", "export", "marble-rain", "--animate", "30", "--seconds", "2", "-o", glb});
  ASSERT_EQ(exported.exit_code, 0) << exported.output;
  const Outcome heard = ringdown({"foley", glb, "-o", wav, "--report", report, "--tail", "0"});
  EXPECT_EQ(heard.exit_code, 0) << heard.output;
  EXPECT_GT(count(report, "impact"), 20u);

  // The file is a scene, too, of which a second recording is made, at another rate.
  const Outcome again =
      ringdown({"scene", "export", glb, "--animate", "24", "--seconds", "1", "-o", folder_ / "again.glb"});
  EXPECT_EQ(again.exit_code, 0) << again.output;
}

TEST_F(FoleyVerb, APlainRecordingAsksForABake) {
  const std::string glb = folder_ / "rain.glb";
  const Outcome exported =
      ringdown({"scene", "export", "marble-rain", "--animate", "30", "--seconds", "1.5", "--plain", "-o", glb});
  ASSERT_EQ(exported.exit_code, 0) << exported.output;
  const Outcome heard = ringdown({"foley", glb, "-o", folder_ / "rain.wav"});
  EXPECT_EQ(heard.exit_code, kSilence);
  EXPECT_NE(heard.output.find("ringdown bake"), std::string::npos) << heard.output;
  const Outcome alone = ringdown({"scene", "export", "marble-rain", "--plain", "-o", glb});
  EXPECT_EQ(alone.exit_code, kUsage);
  EXPECT_NE(alone.output.find("add --animate"), std::string::npos) << alone.output;
}

TEST_F(FoleyVerb, ABakeTakesMaterialsByNameAndFromTheCommandLine) {
  const std::string glb = write_fall("wine glass 02", "Frobnium");
  const std::string wav = folder_ / "fall.wav";
  const std::vector<std::string> bake = {"bake", glb, "--band", "20", "6000"};
  Outcome baked = ringdown(bake);
  EXPECT_EQ(baked.exit_code, 0) << baked.output;
  EXPECT_NE(baked.output.find("Cube: the material 'wine glass 02', taken for glass"), std::string::npos)
      << baked.output;
  EXPECT_NE(baked.output.find("Floor: the material 'Frobnium', not known; it stays silent"), std::string::npos)
      << baked.output;
  const Outcome heard = ringdown({"foley", glb, "-o", wav});
  EXPECT_EQ(heard.exit_code, 0) << heard.output;
  EXPECT_NE(heard.output.find("1 impacts"), std::string::npos) << heard.output;

  const auto with = [&](const std::string& body) {
    std::vector<std::string> arguments = bake;
    arguments.insert(arguments.end(), {"--body", body});
    return ringdown(arguments);
  };
  baked = with("Floor=steel");
  EXPECT_EQ(baked.exit_code, 0) << baked.output;
  const auto floor = modal::read_bank(glb + "#1");
  ASSERT_TRUE(floor) << floor.error().message;
  ASSERT_TRUE(floor->mass);
  EXPECT_NEAR(floor->mass->mass_kg, 0.3 * 0.06 * 0.3 * 7800, 0.5) << "of steel";
  baked = with("Nobody=steel");
  EXPECT_EQ(baked.exit_code, kBadInput);
  EXPECT_NE(baked.output.find("has no silent body of that name"), std::string::npos) << baked.output;
  write_fall("glass", "Frobnium");
  baked = with("Floor=frobnium");
  EXPECT_EQ(baked.exit_code, kBadInput);
  EXPECT_NE(baked.output.find("no such material"), std::string::npos) << baked.output;
}

}  // namespace
}  // namespace ringdown::test
