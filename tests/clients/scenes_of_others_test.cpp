// `ringdown render` of scenes as other programs write them: each is heard, or says why it is not. Small ones that the
// test writes run always; public ones are read from the folder that RINGDOWN_GLTF_SAMPLES names.
#include "engine/modal/bank_file.h"
#include "tests/integration/process.h"
#include "tests/integration/sound_file.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace ringdown::test {
namespace {

namespace fs = std::filesystem;

constexpr int kSilence = 7;  // docs/reference/settings.md

const std::string kMotion = R"("motion": {"mass": 0.1}, "collider": {"geometry": {"shape": 0}})";

// A node with a body of one of the shapes.
std::string node(const std::string& name, const std::string& physics, double height_m, const std::string& audio = "") {
  return R"({"name": ")" + name + R"(", "translation": [0, )" + std::to_string(height_m) +
         R"(, 0], "extensions": {"KHR_physics_rigid_bodies": {)" + physics + "}" +
         (audio.empty() ? "" : R"(, "KHR_audio_rigid_bodies": {)" + audio + "}") + "}}";
}

std::string document(const std::string& nodes, const std::string& more = "") {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}], "nodes": [)" + nodes +
         R"(], "extensions": {"KHR_implicit_shapes": {"shapes": [{"type": "sphere", "sphere": {"radius": 0.02}},
            {"type": "box", "box": {"size": [2, 0.1, 2]}}]}, "KHR_physics_rigid_bodies": {}, "KHR_audio_rigid_bodies": {"acousticSurfaces":
            [{"material": 0}], "acousticMaterials": [{"name": "Steel"}]}})" +
         more + "}";
}

const std::string kFloor = node("Floor", R"("collider": {"geometry": {"shape": 1}})", -0.05);

// A steel bead as a solved model has it: its modes, and its mass.
modal::Bank bead(double frequency_hz) {
  modal::Bank bank;
  bank.name = "bead";
  bank.frequency_hz = {frequency_hz, 1.05 * frequency_hz};
  bank.decay_per_s = {30, 40};
  for (const float x : {-0.02F, 0.02F}) {
    for (int axis = 0; axis < 3; ++axis) {
      modal::Vec3f point{};
      point[static_cast<std::size_t>(axis)] = x;
      bank.positions.push_back(point);
    }
  }
  for (std::size_t k = 0; k < 2 * bank.positions.size(); ++k) bank.shapes.push_back({0, 0, 3});
  bank.triangles = {{0, 1, 2}, {3, 5, 4}};
  modal::MassProperties mass;
  mass.mass_kg = 0.26;
  mass.inertia_kg_m2 = {4.2e-5, 4.2e-5, 4.2e-5};
  bank.mass = mass;
  return bank;
}

class ScenesOfOthers : public testing::Test {
 protected:
  Outcome render(const fs::path& scene, const std::string& seconds = "1") {
    return run({RINGDOWN_BIN_DIR "/ringdown", "render", "--scene", scene, "--seconds", seconds, "-o", sound_});
  }

  Outcome render_text(const std::string& name, const std::string& text) { return render(folder_.write(name, text)); }

  void expect_silence(const Outcome& ran, const std::vector<std::string>& words) {
    EXPECT_EQ(ran.exit_code, kSilence) << ran.output;
    for (const std::string& word : words)
      EXPECT_NE(ran.output.find(word), std::string::npos) << word << ": " << ran.output;
    EXPECT_EQ(peak(), 0) << "the file is there all the same";
  }

  double peak() {
    double max = 0;
    for (const double sample : read_left(sound_)) max = std::max(max, std::abs(sample));
    return max;
  }

  std::string bead_scene(double frequency_hz, const std::string& more = "") {
    EXPECT_TRUE(modal::write_bank(bead(frequency_hz), folder_ / "bead.glb"));
    return R"([[object]]
name = "bead"
bank = "bead.glb"
[[static]]
name = "floor"
shape = "plane"
[[body]]
name = "steel bead"
object = "bead"
shape = "sphere"
radius_m = 0.02
density_kg_m3 = 7850
position_m = [0, 0, 0.1]
)" + more;
  }

  TemporaryFolder folder_;
  fs::path sound_ = folder_ / "sound.wav";
};

TEST_F(ScenesOfOthers, BodiesWithoutBanksSayWhatGivesThemSome) {
  expect_silence(render_text("plain.gltf", document(node("Ball", kMotion, 0.3) + "," + kFloor)),
                 {"nothing in it can sound", "'Ball', 'Floor'", "have no bank", "acoustic surfaces", "ringdown bake "});
  expect_silence(
      render_text("steel.gltf", document(node("Ball", kMotion, 0.3, R"("acousticSurface": 0)") + "," + kFloor)),
      {"nothing in it can sound", "steel.gltf` gives them banks"});
}

TEST_F(ScenesOfOthers, AnimationsAloneStrikeNothing) {
  expect_silence(render_text("moving.gltf", document(R"({"name": "A"}, {"name": "B"})")), {"it has no bodies"});
  const std::string scene = bead_scene(2000);
  const Outcome objects = render_text("objects.toml", scene.substr(0, scene.find("[[static]]")));
  EXPECT_EQ(objects.output.find("nothing in it can sound"), std::string::npos) << "they wait for requests";
}

TEST_F(ScenesOfOthers, ASceneInWhichNothingIsFreeToMoveSaysSo) {
  std::string scene = bead_scene(3000);
  expect_silence(render_text("still.toml", scene + "fixed = true\n"), {"no body is free to move"});
  EXPECT_EQ(render_text("free.toml", scene).exit_code, 0);
}

// The modes of a small steel ball lie above hearing, but the air hears how it is stopped.
TEST_F(ScenesOfOthers, ABallThatRingsAboveHearingIsNamedAndClicks) {
  const Outcome ran = render_text("bead.toml", bead_scene(63100));
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_NE(ran.output.find("'steel bead' rings above hearing: its lowest mode is at 63.1 kHz"), std::string::npos)
      << ran.output;
  EXPECT_GT(peak(), 1e-4);
  expect_silence(render_text("mute.toml", bead_scene(63100, "[contact]\nclicks = false\n")),
                 {"rings above hearing", "has no clicks"});
  EXPECT_EQ(render_text("bell.toml", bead_scene(2000)).output.find("above hearing"), std::string::npos);
}

TEST_F(ScenesOfOthers, SilenceThatWasAskedForIsNoFailure) {
  EXPECT_EQ(run({RINGDOWN_BIN_DIR "/ringdown", "render", "--seconds", "0.1", "-o", sound_}).exit_code, 0);
  const Outcome early = render(folder_.write("early.toml", bead_scene(2000)), "0.01");
  EXPECT_EQ(early.exit_code, kSilence) << early.output;
  EXPECT_NE(early.output.find("nothing that sounds was struck"), std::string::npos) << early.output;
}

// Reads the bank of a bead that a drive pulls over the floor, free along all axes and turning about none.
TEST_F(ScenesOfOthers, ABodyThatSlidesWithoutTurningIsHeard) {
  const Outcome ran = render_text("squeak.toml", bead_scene(2000, R"([[joint]]
name = "bow"
type = "free"
bodies = ["steel bead"]
anchor_m = [0, 0, 0.1]
limits = [{ about = "x", low = 0, high = 0 }, { about = "y", low = 0, high = 0 }, { about = "z", low = 0, high = 0 }]
drives = [{ along = "x", damping = 1e6, speed = 0.2, most = 10 }]
)"));
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  const std::vector<double> samples = read_left(sound_);
  const auto late = std::span(samples).last(samples.size() / 10);
  EXPECT_GT(std::ranges::max(late), 0) << "it still slides at the end";
}

// Public scenes of the drafts, where there are some.
TEST_F(ScenesOfOthers, PublicScenesAreHeardOrSayWhyNot) {
  const char* const named = std::getenv("RINGDOWN_GLTF_SAMPLES");
  const fs::path samples = named ? fs::path(named) : fs::path(RINGDOWN_SOURCE_DIR) / "../shared/gltf/samples";
  if (!fs::is_directory(samples))
    GTEST_SKIP() << "there are no sample scenes in " << samples << "; RINGDOWN_GLTF_SAMPLES names their folder";
  std::size_t read = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(samples)) {
    if (entry.path().extension() != ".gltf" && entry.path().extension() != ".glb") continue;
    ++read;
    const Outcome ran = render(entry.path(), "2");
    EXPECT_TRUE(ran.exit_code == 0 || ran.exit_code == kSilence) << entry.path() << ": " << ran.output;
    EXPECT_EQ(ran.output.find("joint"), std::string::npos) << entry.path() << ": " << ran.output;
    const bool told = ran.output.find("nothing in it can") != std::string::npos ||
                      ran.output.find("nothing that sounds was struck") != std::string::npos;
    EXPECT_EQ(ran.exit_code == kSilence, told) << entry.path() << ": " << ran.output;
  }
  EXPECT_GT(read, 0U) << samples << " holds no scene";
}

}  // namespace
}  // namespace ringdown::test
