// `ringdown render`: of a score whose bundles carry time tags, where each is heard in the file; of preset scenes, that
// the file is the same each time.
#include "engine/modal/bank_file.h"
#include "protocol/bulk.h"
#include "protocol/schema.h"
#include "protocol/wire/score.h"
#include "tests/integration/daemon_fixture.h"
#include "tests/integration/sound_file.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace ringdown::test {
namespace {

// A strike without contact time is a sine that begins at zero: its frame is the last silent one.
std::vector<double> onsets(const Samples& samples) {
  std::vector<double> found;
  std::size_t last_heard = 0;
  for (std::size_t n = 1; n < samples.size(); ++n) {
    if (std::abs(samples[n]) < 1e-5) continue;
    if (found.empty() || n - last_heard > 200) found.push_back(static_cast<double>(n - 1));
    last_heard = n;
  }
  return found;
}

class RenderTest : public testing::Test {
 protected:
  RenderTest() { EXPECT_TRUE(modal::write_bank(single_mode_bank(3000, 1500), folder_ / "tick.glb")); }

  // Times that lie between frames, at the edges of blocks, and nowhere in particular.
  static std::vector<double> times(double rate_hz) {
    std::vector<double> at = {255.5 / rate_hz, 1.0 / 3, 0.5};
    for (int i = 1; i < 30; ++i) at.push_back(0.6 + 0.0371 * i + 0.1 * i / rate_hz);
    return at;
  }

  Samples render(const std::vector<wire::ScoreEvent>& events, double rate_hz, int block) {
    const auto score = folder_ / "score.osc", sound = folder_ / "sound.wav";
    EXPECT_TRUE(wire::write_score(events, score));
    const Outcome outcome = run({program("ringdown"), "render", "--events", score.string(), "--object",
                                 "tick=" + (folder_ / "tick.glb").string(), "--rate", std::to_string(rate_hz),
                                 "--block", std::to_string(block), "--seconds", "2", "-o", sound.string()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return read_left(sound);
  }

  static void expect_at(const std::vector<double>& times_s, const Samples& samples, double rate_hz) {
    const std::vector<double> heard = onsets(samples);
    ASSERT_EQ(heard.size(), times_s.size());
    for (std::size_t i = 0; i < heard.size(); ++i) EXPECT_NEAR(heard[i], times_s[i] * rate_hz, 1) << times_s[i] << " s";
  }

  TemporaryFolder folder_;
};

TEST_F(RenderTest, EveryBundleIsHeardWithinASampleOfItsTime) {
  for (const double rate_hz : {44100.0, 48000.0, 96000.0}) {
    for (const int block : {1, 64, 100, 1024}) {
      std::vector<wire::ScoreEvent> events;
      for (const double time_s : times(rate_hz)) {
        events.push_back({time_s, protocol::format(protocol::Request(
                                      protocol::Strike{{.name = "tick"}, {{1, 0, 0}, {0, 0, 0.5}, 0}}))});
      }
      SCOPED_TRACE(std::to_string(rate_hz) + " Hz, blocks of " + std::to_string(block));
      expect_at(times(rate_hz), render(events, rate_hz, block), rate_hz);
    }
  }
}

TEST_F(RenderTest, AnAmbisonicFileHasAChannelForEachHarmonic) {
  const auto score = folder_ / "score.osc", sound = folder_ / "field.wav";
  const wire::Message strike =
      protocol::format(protocol::Request(protocol::Strike{{.name = "tick"}, {{1, 0, 0}, {0, 0, 0.5}, 0}}));
  const std::vector<wire::ScoreEvent> events = {{0.1, {"/object/tick/pan", {-1.f}}}, {0.5, strike}};
  ASSERT_TRUE(wire::write_score(events, score));
  const Outcome outcome =
      run({program("ringdown"), "render", "--events", score.string(), "--object",
           "tick=" + (folder_ / "tick.glb").string(), "--ambisonics", "2", "--seconds", "1", "-o", sound.string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  const std::vector<Samples> channels = read_channels(sound);
  ASSERT_EQ(channels.size(), 9);
  ASSERT_GT(peak(channels[0]), 1e-4);
  EXPECT_NEAR(peak(channels[1]), 0.5 * peak(channels[0]), 1e-5 * peak(channels[0])) << "30 degrees to the left";
  EXPECT_EQ(peak(channels[2]), 0) << "not above, nor below";
  EXPECT_NEAR(peak(channels[3]), std::sqrt(0.75) * peak(channels[0]), 1e-5 * peak(channels[0]));
}

TEST_F(RenderTest, EveryRecordOfABulkIsHeardWithinASampleOfItsDelay) {
  constexpr double kRate_hz = 48000, kBundle_s = 0.05;
  std::vector<protocol::BulkStrike> strikes;
  std::vector<double> heard_s = times(kRate_hz);
  for (double& time_s : heard_s) {
    strikes.push_back({0, 0, {}, {0, 0, 0.5}, 0, time_s});
    time_s += kBundle_s;
  }
  const auto message = protocol::format(protocol::Request(protocol::StrikeMany{protocol::encode_strikes(strikes)}));
  expect_at(heard_s, render({{kBundle_s, message}}, kRate_hz, 256), kRate_hz);
}

TEST_F(RenderTest, OneStrikeSoundsAsInAScore) {
  const auto bank = (folder_ / "tick.glb").string(), score = (folder_ / "score.osc").string();
  const wire::Message strike =
      protocol::format(protocol::Request(protocol::Strike{{.name = "x"}, {{1, 0, 0}, {0, 0, 0.25}, 0.001}}));
  ASSERT_TRUE(wire::write_score(std::vector<wire::ScoreEvent>{{0, strike}}, score));
  const auto sound_of = [&](std::vector<std::string> arguments) {
    const auto sound = folder_ / "sound.wav";
    arguments.insert(arguments.begin(), {program("ringdown"), "render", "--tail", "0.5", "-o", sound.string()});
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("dBTP"), std::string::npos) << outcome.output;
    return read_channels(sound);
  };
  const auto expected = sound_of({"--events", score, "--object", "x=" + bank});
  EXPECT_GT(peak(expected.at(0)), 1e-4);
  EXPECT_EQ(sound_of({"--strike", bank, "--at", "1,0,0", "--impulse", "0,0,0.25", "--contact-time", "0.001"}),
            expected);
  EXPECT_GT(peak(sound_of({"--strike", bank}).at(0)), 0.01) << "a default blow is heard";
}

TEST_F(RenderTest, TakesOfOneStrikeVaryAsAskedAndAreTheSameAgain) {
  const auto takes_of = [&](const std::string& name, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {program("ringdown"), "render", "--strike", (folder_ / "tick.glb").string(),
                                         "--takes", "3", "-o", (folder_ / (name + ".wav")).string()});
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    std::vector<Samples> takes;
    for (const char* number : {"1", "2", "3"}) {
      takes.push_back(read_channels(folder_ / (name + "-" + number + ".wav")).at(0));
    }
    return takes;
  };
  const std::vector<std::string> still = {"--scatter", "0", "--vary-contact", "0"};
  const auto same = takes_of("same", still);
  EXPECT_GT(peak(same[0]), 0.01);
  EXPECT_NEAR(static_cast<double>(same[0].size()) / 48000, 2.03, 1e-3) << "until a second is silent, and a fade";
  EXPECT_TRUE(same[0] == same[1] && same[1] == same[2]) << "nothing is varied";
  std::vector<std::string> loud = still;
  loud.insert(loud.end(), {"--vary-impulse", "1", "--seed", "7"});
  const auto louder = takes_of("loud", loud);
  for (std::size_t i = 0; i < louder.size(); ++i) {
    const double factor = peak(louder[i]) / peak(same[0]);
    EXPECT_TRUE(factor >= 0.5 && factor <= 2) << factor;
    for (std::size_t other = 0; other < i; ++other) EXPECT_NE(peak(louder[i]), peak(louder[other]));
  }
  EXPECT_EQ(takes_of("again", loud), louder) << "one seed";
  loud.back() = "8";
  EXPECT_NE(takes_of("other", loud), louder) << "another";
}

TEST_F(RenderTest, AStrikeIsRenderedAlone) {
  const std::string bank = (folder_ / "tick.glb").string(), sound = (folder_ / "sound.wav").string();
  for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--strike", bank, "--scene", "demo"},
                                                {"--at", "0,0,0"},
                                                {"--strike", "no-such-bank"}}) {
    std::vector<std::string> arguments = {program("ringdown"), "render", "-o", sound};
    arguments.insert(arguments.end(), wrong.begin(), wrong.end());
    EXPECT_NE(run(arguments).exit_code, 0) << wrong[0];
    EXPECT_FALSE(std::filesystem::exists(sound));
  }
}

// Two processes, the same file to the last bit.
class PresetScene : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(PresetScene, APresetSceneIsRenderedTheSameEachTime) {
  TemporaryFolder folder;
  std::array<std::string, 2> bytes;
  for (std::string& all : bytes) {
    const auto sound = folder / "sound.wav";
    const Outcome outcome =
        run({program("ringdown"), "render", "--scene", GetParam().string(), "--seconds", "3", "-o", sound.string()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    std::ifstream file(sound, std::ios::binary);
    all.assign(std::istreambuf_iterator<char>(file), {});
  }
  EXPECT_GT(bytes[0].size(), 3u * 48000 * 2 * 2);
  EXPECT_TRUE(bytes[0] == bytes[1]);
}

std::vector<std::filesystem::path> preset_scenes() {
  std::vector<std::filesystem::path> scenes;
  for (const auto& entry : std::filesystem::directory_iterator(RINGDOWN_SOURCE_DIR "/presets/scenes")) {
    if (entry.path().extension() == ".toml") scenes.push_back(entry.path());
  }
  std::ranges::sort(scenes);
  return scenes;
}

INSTANTIATE_TEST_SUITE_P(All, PresetScene, testing::ValuesIn(preset_scenes()), [](const auto& scene) {
  std::string name = scene.param.stem().string();
  std::ranges::replace(name, '-', '_');
  return name;
});

}  // namespace
}  // namespace ringdown::test
