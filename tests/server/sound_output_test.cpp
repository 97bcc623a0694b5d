// What a rendering writes: its length and fades, its part, stems that sum to the mix, loudness and takes.
#include "engine/modal/bank_file.h"
#include "server/session/loudness.h"
#include "server/session/offline.h"
#include "server/session/variation.h"
#include "tests/integration/sound_file.h"
#include "tests/server/animated_room.h"
#include "tests/support/keep_signals.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <sndfile.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <set>
#include <vector>

namespace ringdown::session {
namespace sound_output_test {
namespace {

using test::AnimatedRoom;
using test::Samples;

const Progress kGoOn = [](double) { return true; };

class SoundOutput : public testing::Test {
 protected:
  // A ball that slides and then rolls, and boxes that fall on each other and slide, before a listener.
  OfflineOptions scene() {
    EXPECT_TRUE(modal::write_bank(test::random_bank(1, 60, 40), folder_ / "a.glb"));
    EXPECT_TRUE(modal::write_bank(test::random_bank(2, 35, 40), folder_ / "b.glb"));
    EXPECT_TRUE(modal::write_bank(test::random_bank(3, 25, 40), folder_ / "c.glb"));
    std::ofstream(folder_ / "scene.toml") << R"([scene]
duration_s = 1.5
[listener]
position_m = [0, -1.5, 0.4]
target_m = [0, 0, 0]
[[object]]
name = "ball"
bank = "a.glb"
[[object]]
name = "box"
bank = "b.glb"
gain = 0.3
[[object]]
name = "floor"
bank = "c.glb"
pan = 0.4
[[body]]
name = "floor"
object = "floor"
shape = "box"
size_m = [4, 4, 0.1]
position_m = [0, 0, -0.05]
fixed = true
[[body]]
name = "ball"
object = "ball"
shape = "sphere"
radius_m = 0.05
density_kg_m3 = 2000
position_m = [0.5, 0, 0.05]
velocity_m_s = [-1.5, 0, 0]
[[body]]
name = "box"
object = "box"
shape = "box"
size_m = [0.1, 0.1, 0.05]
density_kg_m3 = 2000
position_m = [0.02, 0, 0.5]
velocity_m_s = [0.6, 0.3, 0]
)";
    return {.scene = folder_ / "scene.toml"};
  }

  OfflineOptions animation() {
    return {.scene = AnimatedRoom::write(folder_ / "room.glb"), .foley = scene::FoleyLimits{}};
  }

  Rendering render(const OfflineOptions& options, const char* name, const FileOptions& file = {}) {
    const auto rendering = render_to_file(options, folder_ / name, kGoOn, file);
    EXPECT_TRUE(rendering) << rendering.error().message;
    return rendering.value_or(Rendering());
  }

  // Every stem of a folder, added up.
  std::vector<Samples> sum_of_stems(const std::filesystem::path& stems, std::set<std::string>& names) {
    std::vector<Samples> sum;
    for (const auto& entry : std::filesystem::directory_iterator(stems)) {
      names.insert(entry.path().filename());
      const auto channels = test::read_channels(entry.path());
      if (sum.empty()) sum.assign(channels.size(), Samples(channels[0].size()));
      EXPECT_EQ(channels[0].size(), sum[0].size()) << entry.path();
      for (std::size_t c = 0; c < sum.size(); ++c) {
        for (std::size_t n = 0; n < sum[c].size(); ++n) sum[c][n] += channels[c][n];
      }
    }
    return sum;
  }

  void expect_stems_sum_to_the_mix(OfflineOptions options, const std::set<std::string>& expected) {
    options.fade_s = kFade_s;
    const Rendering rendering = render(options, "mix.wav", {.stems = folder_ / "stems"});
    std::set<std::string> names;
    const auto sum = sum_of_stems(folder_ / "stems", names);
    const auto mix = test::read_channels(folder_ / "mix.wav");
    EXPECT_EQ(names, expected);
    EXPECT_EQ(rendering.stems, expected.size());
    ASSERT_EQ(sum.size(), mix.size());
    for (std::size_t c = 0; c < mix.size(); ++c) {
      ASSERT_EQ(sum[c].size(), mix[c].size());
      test::KeepSignals keep(48000);
      keep.add("mix", mix[c]);
      keep.add("sum-of-stems", sum[c]);
      EXPECT_GT(test::peak(mix[c]), 1e-4) << c;
      EXPECT_LT(test::relative_error_db(sum[c], mix[c]), -100) << c;
    }
  }

  test::TemporaryFolder folder_;
};

TEST_F(SoundOutput, StemsOfASimulatedSceneSumToTheMix) {
  expect_stems_sum_to_the_mix(
      scene(), {"ball-impact.wav", "ball-slide.wav", "ball-roll.wav", "box-impact.wav", "box-slide.wav", "box-roll.wav",
                "floor-impact.wav", "floor-slide.wav", "floor-roll.wav"});
}

TEST_F(SoundOutput, StemsOfAnAmbisonicFieldSumToIt) {
  OfflineOptions options = scene();
  options.mixer.ambisonic_order = 1;
  options.tail_s = 0;
  expect_stems_sum_to_the_mix(
      options, {"ball-impact.wav", "ball-slide.wav", "ball-roll.wav", "box-impact.wav", "box-slide.wav", "box-roll.wav",
                "floor-impact.wav", "floor-slide.wav", "floor-roll.wav"});
}

TEST_F(SoundOutput, StemsOfAPartOfAnAnimationSumToIt) {
  OfflineOptions options = animation();
  options.camera = "Ride";
  options.from_s = 0.1;
  options.to_s = 1.1;
  expect_stems_sum_to_the_mix(options, {"Cube-impact.wav", "Sled-slide.wav", "Table-impact.wav", "Table-slide.wav"});
}

// A gong amplifies the smallest difference of its rounding, and balls feel the plate on which they roll.
TEST_F(SoundOutput, StemsOfBodiesThatAnswerTheirVibrationSumToTheMix) {
  const std::filesystem::path scenes = RINGDOWN_SOURCE_DIR "/presets/scenes";
  for (const char* name : {"gongs", "rolling-balls"}) {
    std::filesystem::remove_all(folder_ / "stems");
    render({.scene = scenes / (name + std::string(".toml")), .seconds = 3}, "mix.wav", {.stems = folder_ / "stems"});
    std::set<std::string> names;
    const auto sum = sum_of_stems(folder_ / "stems", names);
    EXPECT_LT(test::relative_error_db(sum[0], test::read_left(folder_ / "mix.wav")), -100) << name;
    EXPECT_GT(names.size(), 1u) << name;
  }
}

// What sounds before the limiter has its place in the stems: they have no delay.
TEST_F(SoundOutput, StemsHaveTheTimeOfALimitedMix) {
  OfflineOptions options = animation();
  options.mixer.limiter_db = -1;
  ASSERT_LT(render(options, "mix.wav", {.stems = folder_ / "stems"}).peak, 0.8);  // the limiter has only its delay
  std::set<std::string> names;
  const auto sum = sum_of_stems(folder_ / "stems", names);
  EXPECT_LT(test::relative_error_db(sum[0], test::read_left(folder_ / "mix.wav")), -100);
}

TEST_F(SoundOutput, WithoutATailASoundHasTheLengthOfItsSceneAndFadesWithinIt) {
  for (OfflineOptions options : {scene(), animation()}) {
    options.seconds.reset();
    options.tail_s = 0;
    const auto whole = render_offline(options, kGoOn);
    options.fade_s = kFade_s;
    const auto faded = render_offline(options, kGoOn);
    ASSERT_TRUE(whole && faded);
    ASSERT_EQ(faded->left.size(), 72000u);
    const std::size_t until = 72000 - 1440;
    EXPECT_TRUE(std::equal(whole->left.begin(), whole->left.begin() + until, faded->left.begin()));
    EXPECT_LT(std::abs(faded->left.back()), 1e-5 * faded->peak);
    for (std::size_t n = until; n < 72000; ++n) EXPECT_LE(std::abs(faded->left[n]), std::abs(whole->left[n]));
    options.tail_s = 0.25;
    EXPECT_EQ(render_offline(options, kGoOn)->left.size(), 84000u);
  }
}

// After the scene's end nothing begins any more, and the tail rings out.
TEST_F(SoundOutput, ASoundEndsSilent) {
  for (OfflineOptions options : {scene(), animation()}) {
    options.fade_s = kFade_s;
    const auto sound = render_offline(options, kGoOn);
    ASSERT_TRUE(sound) << sound.error().message;
    const std::size_t length = sound->left.size();
    EXPECT_EQ((length - 72000 - 1440) % 48000, 0u) << "whole seconds and the fade";
    EXPECT_GT(length, 72000u + 48000);
    float last = 0;
    for (std::size_t n = length - 1440 - 48000; n < length; ++n) last = std::max(last, std::abs(sound->left[n]));
    EXPECT_LT(20 * std::log10(last), -96) << "the last second";
    EXPECT_GT(sound->peak, 0.001);
  }
}

TEST_F(SoundOutput, APartIsThatOfTheWhole) {
  OfflineOptions options = animation();
  options.fade_s = kFade_s;
  const auto whole = render_offline(options, kGoOn);
  options.from_s = 0.3, options.to_s = 1.0, options.tail_s = 0;
  const auto part = render_offline(options, kGoOn);
  ASSERT_TRUE(whole && part) << part.error().message;
  ASSERT_EQ(part->left.size(), 33600u);
  const auto rise = static_cast<std::ptrdiff_t>(kRise_s * 48000), fall = static_cast<std::ptrdiff_t>(kFade_s * 48000);
  EXPECT_EQ(part->left[0], 0);
  EXPECT_TRUE(std::equal(part->left.begin() + rise, part->left.end() - fall, whole->left.begin() + 14400 + rise));
  options.from_s = 1.0;
  const auto none = render_offline(options, kGoOn);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::usage);
}

TEST_F(SoundOutput, SamplesOf24BitsAreThoseOfFloats) {
  const OfflineOptions options = animation();
  render(options, "float.wav");
  render(options, "24.wav", {.bits = 24});
  SF_INFO info{};
  SNDFILE* file = sf_open((folder_ / "24.wav").c_str(), SFM_READ, &info);
  ASSERT_TRUE(file);
  sf_close(file);
  EXPECT_EQ(info.format, SF_FORMAT_WAV | SF_FORMAT_PCM_24);
  EXPECT_EQ(info.samplerate, 48000);
  const auto floats = test::read_frames(folder_ / "float.wav"), whole = test::read_frames(folder_ / "24.wav");
  ASSERT_EQ(floats.size(), whole.size());
  double worst = 0;
  for (std::size_t n = 0; n < floats.size(); ++n) worst = std::max(worst, std::abs(floats[n] - whole[n]));
  EXPECT_LE(worst, 0x1p-23);
}

std::vector<float> sine(double frequency_hz, double amplitude, double seconds, double phase = 0) {
  std::vector<float> samples(static_cast<std::size_t>(48000 * seconds));
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const double turns = frequency_hz * static_cast<double>(n) / 48000;
    samples[n] = static_cast<float>(amplitude * std::sin(2 * std::numbers::pi * turns + phase));
  }
  return samples;
}

double from_db(double db) { return std::pow(10, db / 20); }

// EBU Tech 3341, table 1, cases 1 to 3.
TEST_F(SoundOutput, LoudnessIsThatOfTheTestSignalsOfTheEbu) {
  for (const double level : {-23.0, -33.0}) {
    Loudness loudness(48000);
    const auto tone = sine(1000, from_db(level), 20);
    loudness.add(tone, tone);
    EXPECT_NEAR(loudness.lufs().value(), level, 0.1);
  }
  Loudness steps(48000);
  for (const auto& [level, seconds] : {std::pair(-36.0, 10.0), {-23.0, 60.0}, {-36.0, 10.0}}) {
    const auto tone = sine(1000, from_db(level), seconds);
    steps.add(tone, tone);
  }
  EXPECT_NEAR(steps.lufs().value(), -23, 0.1) << "the gate leaves out what is quieter";
  Loudness sine_997(48000);  // ITU-R BS.1770: a sine of 997 Hz at full scale in one channel
  sine_997.add(sine(997, 1, 5), std::vector<float>(240000));
  EXPECT_NEAR(sine_997.lufs().value(), -3.01, 0.02);
  Loudness silence(48000);
  silence.add(std::vector<float>(48000), std::vector<float>(48000));
  EXPECT_FALSE(silence.lufs());
  EXPECT_EQ(silence.true_peak(), 0);
}

// EBU Tech 3341, table 1, cases 15 to 18: tones between whose peaks the samples lie.
TEST_F(SoundOutput, TruePeaksLieBetweenSamples) {
  for (const auto& [share, phase] : {std::pair(0.25, 45.0), {1.0 / 6, 60.0}, {1.0 / 8, 67.5}}) {
    Loudness loudness(48000);
    auto tone = sine(48000 * share, 0.5, 0.5, phase * std::numbers::pi / 180);
    for (std::size_t n = 0; n < 4800; ++n) tone[n] *= static_cast<float>(n) / 4800;
    loudness.add(tone, tone);
    const double peak_db = 20 * std::log10(loudness.true_peak());
    EXPECT_GT(peak_db, -6.4) << share;
    EXPECT_LT(peak_db, -5.8) << share;
  }
}

// ITU-R BS.1770-4 by its tables of coefficients for 48 kHz.
double loudness_by_the_standard(const std::vector<Samples>& channels) {
  struct Biquad {
    double b0, b1, b2, a1, a2;
    Samples operator()(const Samples& x) const {
      Samples y(x.size());
      for (std::size_t n = 0; n < x.size(); ++n) {
        const auto at = [n](const Samples& s, std::size_t back) { return n >= back ? s[n - back] : 0.0; };
        y[n] = b0 * x[n] + b1 * at(x, 1) + b2 * at(x, 2) - a1 * at(y, 1) - a2 * at(y, 2);
      }
      return y;
    }
  };
  const Biquad head{1.53512485958697, -2.69169618940638, 1.19839281085285, -1.69065929318241, 0.73248077421585};
  const Biquad low{1, -2, 1, -1.99004745483398, 0.99007225036621};
  std::vector<double> powers;
  const Samples left = low(head(channels[0])), right = low(head(channels[1]));
  for (std::size_t begin = 0; begin + 19200 <= left.size(); begin += 4800) {
    double sum = 0;
    for (std::size_t n = begin; n < begin + 19200; ++n) sum += left[n] * left[n] + right[n] * right[n];
    powers.push_back(sum / 19200);
  }
  const auto mean_above = [&](double gate) {
    double sum = 0, count = 0;
    for (const double power : powers) {
      if (power > gate) sum += power, ++count;
    }
    return sum / count;
  };
  const auto power_of = [](double lufs) { return std::pow(10, (lufs + 0.691) / 10); };
  return -0.691 + 10 * std::log10(mean_above(std::max(power_of(-70), 0.1 * mean_above(power_of(-70)))));
}

TEST_F(SoundOutput, AFileGetsTheLoudnessAskedForAndItsStemsKeepTheirs) {
  const OfflineOptions options = animation();
  const Rendering plain = render(options, "plain.wav");
  const auto before = test::read_channels(folder_ / "plain.wav");
  ASSERT_TRUE(plain.lufs);
  EXPECT_NEAR(*plain.lufs, loudness_by_the_standard(before), 0.05);
  const Rendering made = render(options, "made.wav", {.lufs = -23, .stems = folder_ / "stems"});
  const auto after = test::read_channels(folder_ / "made.wav");
  EXPECT_NEAR(loudness_by_the_standard(after), -23, 0.1);
  EXPECT_NEAR(made.gain, from_db(-23 - *plain.lufs), 1e-6);
  EXPECT_NEAR(made.peak, std::max(test::peak(after[0]), test::peak(after[1])), 1e-6);
  EXPECT_GE(made.true_peak, made.peak * 0.999);
  ASSERT_EQ(after[0].size(), before[0].size());
  Samples louder = before[0];
  for (double& sample : louder) sample *= made.gain;
  EXPECT_LT(test::relative_error_db(after[0], louder), -130);
  std::set<std::string> names;
  EXPECT_LT(test::relative_error_db(sum_of_stems(folder_ / "stems", names)[0], before[0]), -100);
}

TEST_F(SoundOutput, ANearerCameraHearsMore) {
  OfflineOptions options = animation();
  options.tail_s = 0;
  const auto first = render_offline(options, kGoOn);
  options.camera = "Wide";
  const auto wide = render_offline(options, kGoOn);
  options.camera = "Ride";
  const auto ride = render_offline(options, kGoOn);
  ASSERT_TRUE(first && wide && ride);
  EXPECT_EQ(first->left, wide->left);
  // The level goes as one over the distance to the table's middle: the camera comes from 8 to 2 m at 4 m/s.
  const auto level = [](const Recording& sound, double time_s) {
    double sum = 0;
    const auto at = static_cast<std::size_t>(48000 * time_s);
    for (std::size_t n = at; n < at + 2400; ++n) sum += sound.left[n] * sound.left[n] + sound.right[n] * sound.right[n];
    return std::sqrt(sum);
  };
  for (std::size_t k = 0; k < 2; ++k) {  // the third blow comes while the second rings, and the camera shifts its phase
    const double time_s = AnimatedRoom::landings_s()[k];
    const auto distance = [](double z) { return std::hypot(z, 0.5); };
    const double expected = distance(2) / distance(8 - 4 * (time_s + 0.01));
    EXPECT_NEAR(level(*ride, time_s) / level(*wide, time_s), expected, 0.04 * expected) << time_s;
  }
  options.camera = "Nobody";
  const auto none = render_offline(options, kGoOn);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("no camera 'Nobody'; its cameras are 'Wide', 'Ride'"), std::string::npos)
      << none.error().message;
}

TEST_F(SoundOutput, TakesDifferAndAreTheSameAgain) {
  OfflineOptions options = animation();
  options.tail_s = 0;
  const auto plain = render_offline(options, kGoOn);
  options.variation = VariationRange{.seed = 1};
  const auto one = render_offline(options, kGoOn);
  options.block_frames = 100;
  const auto again = render_offline(options, kGoOn);
  options.block_frames = 256;
  options.variation->seed = 2;
  const auto two = render_offline(options, kGoOn);
  const auto error = [](const auto& a, const auto& b) {
    return test::relative_error_db(test::to_doubles(a->left), test::to_doubles(b->left));
  };
  EXPECT_LT(error(again, one), -100);
  EXPECT_GT(error(one, plain), -60);
  EXPECT_GT(error(two, one), -60);
}

TEST(Variation, PointsLieWithinTheBallAndOneBlowIsVariedAlike) {
  const Variation vary({.seed = 5, .point_m = 0.001, .contact_time = 0.1, .impulse = 0.2});
  double farthest_m = 0, longest = 0, mean = 0;
  constexpr int kBlows = 1000;
  for (int k = 0; k < kBlows; ++k) {
    synth::verb::Strike strike{.point_m = {0.3, -0.2, 0.1}, .impulse_ns = {0, 0, 2}, .contact_time_s = 0.001};
    synth::Event one{.frame = 100 * k, .object = 3, .verb = strike},
        other{.frame = 100 * k, .object = 4, .verb = strike};
    vary(one), vary(other);
    const auto &a = *one.verb.get_if<synth::verb::Strike>(), &b = *other.verb.get_if<synth::verb::Strike>();
    const double aside_m = length(a.point_m - strike.point_m), longer = a.contact_time_s / 0.001;
    EXPECT_LE(aside_m, 0.001);
    EXPECT_LE(longer, 1.1 + 1e-12);
    EXPECT_GE(longer, 1 / 1.1 - 1e-12);
    EXPECT_EQ(a.contact_time_s, b.contact_time_s) << "one blow has one contact time";
    EXPECT_EQ(a.impulse_ns, b.impulse_ns) << "and opposite impulses";
    EXPECT_NE(a.point_m, b.point_m);
    farthest_m = std::max(farthest_m, aside_m);
    longest = std::max(longest, longer);
    mean += longer / kBlows;
  }
  EXPECT_GT(farthest_m, 0.0009);
  EXPECT_GT(longest, 1.09);
  EXPECT_NEAR(mean, 1, 0.01);
}

}  // namespace
}  // namespace sound_output_test
}  // namespace ringdown::session
