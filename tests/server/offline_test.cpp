// Rendering without a clock: the same samples every time, whatever the block size.
#include "engine/modal/bank_file.h"
#include "engine/synth/mixer.h"
#include "protocol/schema.h"
#include "protocol/wire/score.h"
#include "server/session/offline.h"
#include "server/session/sound_file.h"
#include "tests/scene/box_bank.h"
#include "tests/support/keep_signals.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <sndfile.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <unistd.h>

namespace ringdown::session {
namespace {

using protocol::format;
using protocol::Request;

class OfflineTest : public testing::Test {
 protected:
  OfflineTest() {
    EXPECT_TRUE(modal::write_bank(test::random_bank(1, 60, 40), folder_ / "a.glb"));
    EXPECT_TRUE(modal::write_bank(test::random_bank(2, 35, 40), folder_ / "b.glb"));
    std::ofstream(folder_ / "scene.toml") << R"(
[[object]]
name = "a"
bank = "a.glb"
pan = -0.5
[[object]]
name = "b"
bank = "b.glb"
gain = 0.3
[[static]]
name = "floor"
shape = "plane"
[[body]]
name = "one"
object = "a"
shape = "sphere"
radius_m = 0.05
density_kg_m3 = 2000
position_m = [0, 0, 0.3]
[[body]]
name = "two"
object = "b"
shape = "box"
size_m = [0.1, 0.1, 0.05]
density_kg_m3 = 2000
position_m = [0.02, 0, 0.7]
)";
  }

  // Everything a score can ask of a session, at awkward times.
  void write_full_score() {
    const std::string a = (folder_ / "a.glb").string(), b = (folder_ / "b.glb").string();
    const protocol::ObjectRef x{.name = "x"}, y{.name = "y"};
    const std::vector<std::pair<double, Request>> requests = {
        {0.0, protocol::LoadObject{"x", a}},
        {0.0, protocol::LoadObject{"y", b}},
        {0.01, protocol::Strike{x, {{0.1, 0, 0}, {0.1, 0.2, 0.3}, 0.0003}}},
        {0.1, protocol::SetGain{x, {0.5, 0.05}}},
        {0.12, protocol::SetGain{x, {2, 0.1}}},  // while the ramp before still runs
        {0.13, protocol::SetPan{x, {0.7}}},
        {0.2003, protocol::StrikeVertex{y, {3, {0, 0, 0.4}, 0}}},
        {0.2003, protocol::StrikeVertex{y, {3, {0.1, 0, 0.4}, 0.001}}},
        {0.3001, protocol::SetMaterial{y, {1, 2, 1.5, 0.8}}},
        {0.4017, protocol::LoadObject{"x", b}},
        {0.45, protocol::Strike{x, {{0, 0.1, 0}, {0.3, 0, 0}, 0.0002}}},
        {0.6, protocol::ClearObject{y}},
        {0.605, protocol::Strike{y, {{0, 0, 0.1}, {0, 0.5, 0}, 0.0002}}},
        {0.8, protocol::FreeObject{x}},
    };
    std::vector<wire::ScoreEvent> events;
    for (const auto& [time_s, request] : requests) events.push_back({time_s, format(request)});
    ASSERT_TRUE(wire::write_score(events, folder_ / "full.osc"));
  }

  Recording render(OfflineOptions options) {
    const auto recording = render_offline(options, [](double) { return true; });
    EXPECT_TRUE(recording) << recording.error().message;
    if (!recording) return {};
    for (const std::string& warning : recording->warnings) ADD_FAILURE() << warning;
    return *recording;
  }

  void expect_equal_at_every_block_size(const OfflineOptions& options) {
    const Recording reference = render(options);
    ASSERT_GT(reference.peak, 1e-3f);
    for (const std::size_t block : {1, 7, 64, 100, 1024, 8192}) {
      OfflineOptions other = options;
      other.block_frames = block;
      const Recording recording = render(other);
      for (const auto channel : {&Recording::left, &Recording::right}) {
        const auto expected = test::to_doubles(reference.*channel), got = test::to_doubles(recording.*channel);
        test::KeepSignals keep(options.sample_rate_hz);
        keep.add("blocks-of-256", expected);
        keep.add("blocks-of-" + std::to_string(block), got);
        EXPECT_LT(test::relative_error_db(got, expected), -100) << "blocks of " << block;
      }
    }
  }

  test::TemporaryFolder folder_;
};

TEST_F(OfflineTest, ASceneIsHeardFromItsListenerTheSameEveryTime) {
  const auto render = [&](const std::string& listener) {
    std::ifstream file(folder_ / "scene.toml");
    std::ofstream(folder_ / "heard.toml") << std::string(std::istreambuf_iterator<char>(file), {}) << listener;
    const auto recording =
        render_offline({.scene = folder_ / "heard.toml", .seconds = 0.7}, [](double) { return true; });
    EXPECT_TRUE(recording) << recording.error().message;
    return *recording;
  };
  const std::string near = "[listener]\nposition_m = [0, -1, 0.3]\ntarget_m = [0, 0, 0.3]\n";
  const std::string far = "[listener]\nposition_m = [0, -8, 0.3]\ntarget_m = [0, 0, 0.3]\n";
  const Recording plain = render(""), heard = render(near), again = render(near), away = render(far);
  EXPECT_NEAR(heard.peak / away.peak, 8, 1);
  EXPECT_NE(plain.left, heard.left);
  EXPECT_EQ(again.left, heard.left);
  EXPECT_EQ(again.right, heard.right);
}

TEST_F(OfflineTest, AScoreSoundsTheSameAtEveryBlockSize) {
  write_full_score();
  expect_equal_at_every_block_size({.score = wire::read_score(folder_ / "full.osc").value(), .seconds = 1});
}

TEST_F(OfflineTest, ASceneSoundsTheSameAtEveryBlockSize) {
  expect_equal_at_every_block_size({.scene = folder_ / "scene.toml", .seconds = 1});
}

TEST_F(OfflineTest, ASceneIsHeardAtItsTime) {
  ASSERT_TRUE(modal::write_bank(test::box_bank({0.1, 0.1, 0.1}, 2), folder_ / "cube.glb"));
  std::ofstream(folder_ / "fall.toml") << R"(
[[object]]
name = "a"
bank = "cube.glb"
[[static]]
name = "floor"
shape = "plane"
[[body]]
name = "ball"
object = "a"
shape = "sphere"
radius_m = 0.05
position_m = [0, 0, 0.25]
)";
  for (const std::size_t block : {64, 1024}) {
    const Recording recording = render({.scene = folder_ / "fall.toml", .seconds = 1, .block_frames = block});
    const auto first = std::ranges::find_if(recording.left, [](float x) { return x != 0; });
    const auto frame = static_cast<double>(first - recording.left.begin());
    EXPECT_NEAR(frame / 48000, std::sqrt(2 * 0.2 / 9.81), 1e-4) << block;
  }
}

// A cube of 2 kg whose one mode moves all its corners up and down by 1/sqrt(kg), on a floor that bears it: the floor's
// damping is 1.5 s/m (1 - e) m g, and half of it adds to the mode's decay.
TEST_F(OfflineTest, ABodyThatRestsOnAFloorFallsSilentSooner) {
  ASSERT_TRUE(modal::write_bank(test::box_bank({0.1, 0.1, 0.1}, 2), folder_ / "cube.glb"));
  const std::string scene = R"(
[[object]]
name = "cube"
bank = "cube.glb"
[[static]]
name = "floor"
shape = "plane"
restitution = 0.4
[[body]]
name = "cube"
object = "cube"
shape = "box"
restitution = 0.4
position_m = [0, 0, 0.05]
[contact]
clicks = false
)";
  const std::vector<wire::ScoreEvent> strike{
      {1.0, format(protocol::StrikeVertex{{.name = "cube"}, {0, {0, 0, 0.01}, 0}})}};
  ASSERT_TRUE(wire::write_score(strike, folder_ / "strike.osc"));
  for (const bool rests : {true, false}) {
    std::ofstream(folder_ / "rest.toml") << scene << (rests ? "" : "rest_damping_s_m = 0\n");
    const Recording recording = render(
        {.scene = folder_ / "rest.toml", .score = wire::read_score(folder_ / "strike.osc").value(), .seconds = 1.5});
    const auto sound = test::to_doubles(recording.left);
    const double decay = test::fit_damped_sinusoid(std::span(sound).subspan(48960), 48000).decay_per_s;
    EXPECT_NEAR(decay, 3 + (rests ? 0.5 * 1.5 * 0.6 * 2 * 9.81 : 0), 0.3) << rests;
  }
}

// The mode of mass 1 begins to move with 0.01 m/s, at the time of the strike.
TEST_F(OfflineTest, PickupsOfAScoreAreAFileOfTheirOwn) {
  ASSERT_TRUE(modal::write_bank(test::single_mode_bank(440, 3), folder_ / "one.glb"));
  const protocol::ObjectRef one{.name = "one"};
  const std::vector<wire::ScoreEvent> score{{0.1, format(protocol::SetPickup{one, {{1, 0, 0}, {0, 0, 1}, 2, 0, 1e6}})},
                                            {0.2, format(protocol::Strike{one, {{1, 0, 0}, {0, 0, 0.01}, 0}})}};
  OfflineOptions options{.score = score, .objects = {{"one", folder_ / "one.glb"}}, .seconds = 0.5, .fade_s = 0.1};
  const auto go = [](double) { return true; };
  const auto done = render_to_file(options, folder_ / "sound.wav", go, {.pickups = folder_ / "felt.wav"});
  ASSERT_TRUE(done) << done.error().message;
  SF_INFO info{};
  SNDFILE* const file = sf_open((folder_ / "felt.wav").c_str(), SFM_READ, &info);
  ASSERT_TRUE(file);
  std::vector<float> samples(static_cast<std::size_t>(info.frames * info.channels));
  sf_readf_float(file, samples.data(), info.frames);
  sf_close(file);
  ASSERT_EQ(info.channels, 2);
  ASSERT_EQ(info.frames, 24000);
  const double omega = 2 * std::numbers::pi * 440;
  for (std::size_t n = 0; n < 24000; ++n) {
    const double t = (static_cast<double>(n) - 9600) / 48000;
    ASSERT_EQ(samples[2 * n], 0) << n;
    ASSERT_NEAR(samples[2 * n + 1], t > 0 ? 1e6 * 0.01 / omega * std::exp(-3 * t) * std::sin(omega * t) : 0, 1e-4) << n;
  }
  options.score.erase(options.score.begin());
  EXPECT_FALSE(render_to_file(options, folder_ / "sound.wav", go, {.pickups = folder_ / "felt.wav"}));
}

TEST_F(OfflineTest, TwoRendersAreTheSameFileBitForBit) {
  write_full_score();
  std::vector<std::string> files;
  for (const char* name : {"first.wav", "second.wav"}) {
    const auto recording = render(
        {.scene = folder_ / "scene.toml", .score = wire::read_score(folder_ / "full.osc").value(), .seconds = 1});
    ASSERT_TRUE(write_audio(recording, folder_ / name));
    std::ifstream file(folder_ / name, std::ios::binary);
    files.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  EXPECT_GT(files[0].size(), 48000u * 8);
  EXPECT_EQ(files[0], files[1]);
}

// Whatever the limiter's delay, the number of channels and where pieces end.
TEST_F(OfflineTest, AFileThatIsWrittenWhileItIsRenderedEqualsOneWrittenFromMemory) {
  write_full_score();
  const auto bytes = [](const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  for (const std::size_t block : {1, 7, 256, 8192}) {
    for (const char* name : {"sound.wav", "field.wav", "sound.flac"}) {
      OfflineOptions options{.scene = folder_ / "scene.toml",
                             .score = wire::read_score(folder_ / "full.osc").value(),
                             .seconds = 0.9,
                             .block_frames = block};
      if (std::string(name) == "field.wav") options.mixer.ambisonic_order = 1;
      const Recording recording = render(options);
      ASSERT_TRUE(write_audio(recording, folder_ / name));
      const std::string expected = bytes(folder_ / name);
      std::filesystem::remove(folder_ / name);
      const auto rendering = render_to_file(options, folder_ / name, [](double) { return true; });
      ASSERT_TRUE(rendering) << rendering.error().message;
      EXPECT_GT(expected.size(), 43200u * 3);
      EXPECT_TRUE(bytes(folder_ / name) == expected) << name << ", blocks of " << block;
      EXPECT_EQ(rendering->peak, recording.peak);
      EXPECT_EQ(rendering->seconds, 0.9);
    }
  }
}

TEST_F(OfflineTest, PitchAndDecayDoNotDependOnTheSampleRate) {
  ASSERT_TRUE(modal::write_bank(test::single_mode_bank(1234.5, 6), folder_ / "tone.glb"));
  const std::vector<wire::ScoreEvent> events = {
      {0.0, format(Request(protocol::Strike{{.name = "tone"}, {{1, 0, 0}, {0, 0, 1}, 0}}))}};
  ASSERT_TRUE(wire::write_score(events, folder_ / "tone.osc"));
  for (const double rate : {22050.0, 44100.0, 48000.0, 96000.0, 192000.0}) {
    const auto recording = render({.score = wire::read_score(folder_ / "tone.osc").value(),
                                   .objects = {{"tone", folder_ / "tone.glb"}},
                                   .seconds = 0.5,
                                   .sample_rate_hz = rate});
    const auto tone = test::fit_damped_sinusoid(test::to_doubles(recording.left), rate);
    EXPECT_NEAR(tone.frequency_hz, 1234.5, 1e-3) << rate;
    EXPECT_NEAR(tone.decay_per_s, 6, 1e-3) << rate;
  }
}

TEST_F(OfflineTest, MoreStrikesInOneBlockThanAQueueHoldsAreAllPlayed) {
  ASSERT_TRUE(modal::write_bank(test::single_mode_bank(500, 1), folder_ / "tone.glb"));
  const std::size_t count = 3 * synth::kQueueCapacity / 2;
  const auto strike = format(Request(protocol::Strike{{.name = "tone"}, {{1, 0, 0}, {0, 0, 1e-3}, 0}}));
  std::vector<wire::ScoreEvent> many;
  for (std::size_t i = 0; i < count; ++i) many.push_back({0.001 + 1e-5 * static_cast<double>(i), strike});
  ASSERT_TRUE(wire::write_score(many, folder_ / "many.osc"));
  OfflineOptions options{.score = wire::read_score(folder_ / "many.osc").value(),
                         .objects = {{"tone", folder_ / "tone.glb"}},
                         .seconds = 1};
  const auto paced = render(options);
  options.block_frames = 8192;
  const auto crowded = render(options);
  EXPECT_LT(test::relative_error_db(test::to_doubles(crowded.left), test::to_doubles(paced.left)), -100);
}

TEST_F(OfflineTest, RefusedRequestsOfAScoreAreReportedWithTheirTime) {
  const std::vector<wire::ScoreEvent> events = {{0.25, {"/object/nobody/gain", {1.f}}}, {0.5, {"/nonsense", {}}}};
  ASSERT_TRUE(wire::write_score(events, folder_ / "bad.osc"));
  const auto recording =
      render_offline({.score = wire::read_score(folder_ / "bad.osc").value()}, [](double) { return true; });
  ASSERT_TRUE(recording);
  ASSERT_EQ(recording->warnings.size(), 2u);
  EXPECT_NE(recording->warnings[0].find("0.25"), std::string::npos) << recording->warnings[0];
  EXPECT_NE(recording->warnings[0].find("nobody"), std::string::npos) << recording->warnings[0];
}

TEST_F(OfflineTest, AScoreEndsAtItsEndMark) {
  ASSERT_TRUE(wire::write_score(std::vector<wire::ScoreEvent>{{0.75, {"/c_set", {0, 0}}}}, folder_ / "end.osc"));
  EXPECT_EQ(render({.score = wire::read_score(folder_ / "end.osc").value()}).left.size(), 36000u);
}

// The bank of one mode falls by 60 dB in `t60_s`.
std::size_t seconds_of_a_blow(const test::TemporaryFolder& folder, double t60_s, OfflineOptions options) {
  EXPECT_TRUE(modal::write_bank(test::single_mode_bank(500, std::log(1000) / t60_s), folder / "one.glb"));
  const protocol::Strike blow{{.name = "one"}, {{}, {0, 0, 0.01}, 0.0002}};
  EXPECT_TRUE(wire::write_score(std::vector<wire::ScoreEvent>{{0.5, format(blow)}}, folder / "one.osc"));
  options.objects = {{"one", folder / "one.glb"}};
  options.score = wire::read_score(folder / "one.osc").value();
  const auto recording = render_offline(options, [](double) { return true; });
  EXPECT_TRUE(recording) << recording.error().message;
  EXPECT_GT(recording->peak, 0);
  EXPECT_EQ(recording->left.size(), recording->right.size());
  for (const auto& channel : recording->ambisonics) EXPECT_EQ(channel.size(), recording->left.size());
  // A score ends half a second after a whole second, because its event does not lie on one.
  EXPECT_EQ((recording->left.size() - 24000) % 48000, 0u);
  return recording->left.size() / 48000;
}

// The blow's sound falls from 0.12 to the 1.6e-5 of -96 dB in 1.3 times the time in which it falls by 60 dB.
TEST_F(OfflineTest, AScoreWithoutEndMarkEndsWhenItsSoundIsSilent) {
  for (const auto limiter : {std::optional<double>(), std::optional(-1.0)}) {
    for (const std::size_t block : {255u, 256u, 8192u}) {
      const OfflineOptions options{.block_frames = block,
                                   .mixer = {.limiter_db = limiter, .ambisonic_order = std::size_t{1}}};
      EXPECT_EQ(seconds_of_a_blow(folder_, 0.5, options), 5u) << "after the shortest tail";
      EXPECT_EQ(seconds_of_a_blow(folder_, 8.75, options), 10u) << "with a last second below -96 dB";
      EXPECT_EQ(seconds_of_a_blow(folder_, 500, options), 60u) << "after the longest tail";
    }
  }
}

TEST_F(OfflineTest, AnEmptyRenderAndACancelledOneAreErrors) {
  EXPECT_FALSE(render_offline({}, [](double) { return true; }));
  EXPECT_FALSE(render_offline({.scene = folder_ / "missing.toml"}, [](double) { return true; }));
  EXPECT_FALSE(render_offline({.scene = folder_ / "scene.toml", .seconds = 1}, [](double) { return false; }));
}

TEST_F(OfflineTest, TheWrittenFileHoldsTheSamples) {
  Recording recording{.sample_rate_hz = 44100, .left = {0.f, 0.25f, -1.5f}, .right = {1.f, 0.f, 0.125f}};
  ASSERT_TRUE(write_audio(recording, folder_ / "three.wav"));
  SF_INFO info{};
  SNDFILE* file = sf_open((folder_ / "three.wav").c_str(), SFM_READ, &info);
  ASSERT_TRUE(file);
  std::vector<float> frames(6);
  EXPECT_EQ(sf_readf_float(file, frames.data(), 3), 3);
  sf_close(file);
  EXPECT_EQ(info.samplerate, 44100);
  EXPECT_EQ(frames, (std::vector<float>{0.f, 1.f, 0.25f, 0.f, -1.5f, 0.125f}));
  EXPECT_FALSE(write_audio(recording, folder_ / "no such folder" / "three.wav"));
}

TEST_F(OfflineTest, AFileThatCannotBeWrittenLeavesNothingBehind) {
  Recording recording{.sample_rate_hz = 768000, .left = {0.f}, .right = {0.f}};  // more than FLAC has room for
  const auto files = [this] { return std::distance(std::filesystem::directory_iterator(folder_.path()), {}); };
  const auto before = files();
  EXPECT_FALSE(write_audio(recording, folder_ / "fast.flac"));
  EXPECT_FALSE(write_audio(recording, folder_ / "sound.ogg"));
  EXPECT_EQ(files(), before);
  EXPECT_TRUE(write_audio(recording, folder_ / "LOUD.WAV"));
}

TEST_F(OfflineTest, ARenderingThatIsCancelledOrCannotBeWrittenLeavesNothingBehind) {
  const auto files = [this] { return std::distance(std::filesystem::directory_iterator(folder_.path()), {}); };
  const auto before = files();
  const OfflineOptions options{.scene = folder_ / "scene.toml", .seconds = 1};
  int turns = 0;
  const auto cancelled = render_to_file(options, folder_ / "sound.wav", [&](double) { return ++turns < 50; });
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().kind, ErrorKind::cancelled);
  EXPECT_EQ(files(), before);
  EXPECT_FALSE(render_to_file(options, folder_ / "sound.ogg", [](double) { return true; }));
  EXPECT_EQ(files(), before);
}

// The lengths of a WAV file have 32 bits.
TEST_F(OfflineTest, ASoundOfMoreThanFourGibibytesIsRf64) {
  for (const auto& [frames, head] :
       {std::pair(std::size_t{86400} * 48000, "RF64"), std::pair(std::size_t{3}, "RIFF")}) {
    auto file = SoundFile::create({folder_ / "day.wav"}, 48000, {.frames = frames});
    ASSERT_TRUE(file) << file.error().message;
    const std::vector<float> samples = {0.5f, -0.5f, 0.25f, 0, 0, 1};
    ASSERT_TRUE(file->write(samples));
    ASSERT_TRUE(file->finish());
    std::string begin(4, ' ');
    std::ifstream(folder_ / "day.wav", std::ios::binary).read(begin.data(), 4);
    EXPECT_EQ(begin, head);
    SF_INFO info{};
    SNDFILE* const read = sf_open((folder_ / "day.wav").c_str(), SFM_READ, &info);
    ASSERT_TRUE(read);
    std::vector<float> heard(6);
    EXPECT_EQ(sf_readf_float(read, heard.data(), 3), 3);
    sf_close(read);
    EXPECT_EQ(heard, samples);
  }
}

}  // namespace
}  // namespace ringdown::session
