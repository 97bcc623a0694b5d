// `ringdown foley` and `ringdown render` as an editor calls them: files, takes, stems, videos, and what they say when
// nothing is heard.
#include "tests/integration/process.h"
#include "tests/integration/sound_file.h"
#include "tests/server/animated_room.h"
#include "tests/support/signal.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace ringdown::test {
namespace film_test {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

Outcome ringdown(Words words) {
  words.insert(words.begin(), RINGDOWN_BIN_DIR "/ringdown");
  return run(words);
}

class Film : public testing::Test {
 protected:
  std::string room(const AnimatedRoom::Parts& parts = {true, true, true}) {
    return AnimatedRoom::write(folder_ / "room.glb", parts);
  }
  Outcome foley(const std::string& animation, Words more = {}) {
    Words words = {"foley", animation, "-o", sound_};
    words.insert(words.end(), more.begin(), more.end());
    return ringdown(words);
  }
  void expect(const Outcome& ran, int exit_code, const std::string& sentence) {
    EXPECT_EQ(ran.exit_code, exit_code) << ran.output;
    EXPECT_NE(ran.output.find(sentence), std::string::npos) << ran.output;
  }

  TemporaryFolder folder_;
  const std::string sound_ = folder_ / "room.wav";
};

TEST_F(Film, TheSoundOfAnAnimationHasItsBlowsAtTheirMoments) {
  const std::string report = folder_ / "contacts.csv";
  const Outcome ran = foley(room(), {"--tail", "0", "--report", report, "--bits", "24"});
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_NE(ran.output.find("room.wav: 1.50 s at 48000 Hz, peak "), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find(" dBTP, -"), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find(" LUFS, 3 impacts, 1 contacts that slide or roll"), std::string::npos) << ran.output;
  const Samples sound = read_left(sound_);
  ASSERT_EQ(sound.size(), 72000u);
  EXPECT_TRUE(fs::exists(report));
  const auto loudest_near = [&](double time_s) {
    const auto at = sound.begin() + static_cast<std::ptrdiff_t>(48000 * time_s);
    return peak(std::vector(at, at + 480));
  };
  for (const double landing_s : AnimatedRoom::landings_s())
    EXPECT_GT(loudest_near(landing_s), 3 * loudest_near(landing_s - 0.012)) << landing_s;
}

TEST_F(Film, EverySilenceSaysWhatIsMissingAndWhatToDo) {
  expect(foley(folder_.write("empty.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "scene": 0,
           "nodes": [{"name": "Lamp"}]})")),
         7, "no mesh of its scene is moved by keyframes");
  expect(foley(room({.moves = false, .meets = true, .banks = true})), 7, "no mesh of its scene is moved by keyframes");
  expect(foley(room({.moves = true, .meets = false, .banks = true})), 7, "push each other");
  expect(foley(room({.moves = true, .meets = true, .banks = false})), 7, "has a bank; `ringdown bake");
  const Outcome rendered = ringdown({"render", "--scene", room(), "-o", sound_, "--tail", "0"});
  expect(rendered, 7, "is digital silence: nothing that sounds was struck");
  expect(rendered, 7, "by `ringdown foley ");
}

TEST_F(Film, WrongRequestsAreRefusedBeforeAnythingIsRendered) {
  const std::string animation = room();
  expect(foley(folder_.write("room.toml", "")), 2, "is no glTF file");
  expect(foley(folder_.write("broken.glb", "glTF")), 3, "broken.glb");
  expect(foley("/nowhere/room.glb"), 3, "/nowhere/room.glb");
  expect(foley(animation, {"--camera", "Nobody"}), 3, "its cameras are 'Wide', 'Ride'");
  expect(foley(animation, {"--from", "9"}), 2, "nothing to render");
  expect(foley(animation, {"--mux", "/nowhere/picture.mp4"}), 3, "there is no file /nowhere/picture.mp4");
  expect(foley(animation, {"--bits", "16"}), 2, "--bits");
  const std::string score("\0\0\0\x28#bundle\0\0\0\0\0\0\0\0\1\0\0\0\x14/c_set\0\0,ii\0\0\0\0\0\0\0\0\0", 44);
  expect(ringdown({"render", "--events", folder_.write("s.osc", score), "-o", sound_, "--stems", folder_ / "stems"}), 2,
         "leave out --events");
  expect(ringdown({"render", "--scene", "demo", "-o", sound_, "--seconds", "1", "--tail", "1"}), 2, "leave out --tail");
  EXPECT_FALSE(fs::exists(sound_));
}

TEST_F(Film, TakesAreNumberedAndTheSeedMakesThemAgain) {
  const std::string animation = room();
  const auto take = [&](int number) { return read_left(folder_ / ("room-" + std::to_string(number) + ".wav")); };
  ASSERT_EQ(foley(animation, {"--takes", "3", "--seed", "7", "--tail", "0"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(sound_));
  const std::vector<Samples> first = {take(1), take(2), take(3)};
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < a; ++b) EXPECT_GT(relative_error_db(first[a], first[b]), -60) << a << " " << b;
  }
  ASSERT_EQ(foley(animation, {"--takes", "2", "--seed", "7", "--tail", "0", "--stems", folder_ / "stems"}).exit_code,
            0);
  EXPECT_EQ(take(2), first[1]);
  EXPECT_TRUE(fs::exists(folder_ / "stems/take-1/Cube-impact.wav"));
  ASSERT_EQ(foley(animation, {"--takes", "1", "--seed", "8", "--tail", "0"}).exit_code, 0);
  EXPECT_GT(relative_error_db(take(1), first[0]), -60);
}

TEST_F(Film, ASoundThatClipsSaysSo) {
  expect(foley(room(), {"--lufs", "0", "--bits", "24", "--tail", "0"}), 0, "24 bits clip there");
  expect(foley(room(), {"--progress-lines", "--tail", "0"}), 0, " rendering\n");
}

// Videos, by ffmpeg.
class Mux : public Film {
 protected:
  void SetUp() override {
    if (run({"sh", "-c", "command -v ffmpeg && command -v ffprobe"}).exit_code != 0)
      GTEST_SKIP() << "ffmpeg is not installed";
    const Outcome made = run({"ffmpeg", "-v", "error", "-f", "lavfi", "-i", "testsrc=d=1.5:r=30:s=64x48", "-pix_fmt",
                              "yuv420p", folder_ / "picture.mp4"});
    ASSERT_EQ(made.exit_code, 0) << made.output;
  }
};

TEST_F(Mux, ASoundIsPutUnderItsVideo) {
  ASSERT_EQ(foley(room(), {"--mux", folder_ / "picture.mp4", "--from", "0.2", "--tail", "0"}).exit_code, 0);
  const fs::path film = folder_ / "room.mp4";
  const Outcome streams = run({"ffprobe", "-v", "error", "-show_entries", "stream=codec_type", "-of", "csv=p=0", film});
  EXPECT_NE(streams.output.find("video"), std::string::npos) << streams.output;
  EXPECT_NE(streams.output.find("audio"), std::string::npos) << streams.output;
  // The part begins at its own moment of the video.
  ASSERT_EQ(run({"ffmpeg", "-v", "error", "-i", film, "-af", "aresample=async=1:first_pts=0", "-c:a", "pcm_f32le",
                 folder_ / "again.wav"})
                .exit_code,
            0);
  const Samples sound = read_left(sound_), again = read_left(folder_ / "again.wav");
  const auto loudest = [](const Samples& s) {
    return std::max_element(s.begin(), s.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }) -
           s.begin();
  };
  EXPECT_NEAR(static_cast<double>(loudest(again)), static_cast<double>(loudest(sound)) + 9600, 100);
  EXPECT_TRUE(fs::exists(folder_ / "picture.mp4"));
}

TEST_F(Mux, AVideoIsNotOverwritten) {
  fs::copy_file(folder_ / "picture.mp4", folder_ / "room.mp4");
  expect(foley(room(), {"--mux", folder_ / "room.mp4"}), 2, "give the sound (-o) another name");
  expect(foley(room(), {"--mux", folder_.write("text.mp4", "no video")}), 1, "ffmpeg could not put the sound under");
}

TEST_F(Film, WithoutFfmpegMuxSaysWhatToInstall) {
  const Outcome ran = run({"env", "PATH=/nowhere", RINGDOWN_BIN_DIR "/ringdown", "foley", room(), "-o", sound_, "--mux",
                           folder_.write("picture.mp4", "")});
  expect(ran, 1, "--mux needs ffmpeg, which is not installed");
}

}  // namespace
}  // namespace film_test
}  // namespace ringdown::test
