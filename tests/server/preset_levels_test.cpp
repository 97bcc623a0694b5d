// Levels of the presets: a single blow of a preset object stays below the limiter's ceiling and is heard, and the
// preset scenes are about equally loud.
#include "engine/modal/bank.h"
#include "server/session/note_map.h"
#include "server/session/offline.h"
#include "server/session/session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

namespace ringdown::session {
namespace {

constexpr double kRate_hz = 48000;
constexpr double kCeiling_db = -1;  // of the limiter, by default
const std::filesystem::path kPresets = RINGDOWN_SOURCE_DIR "/presets";

double decibels(double amplitude) { return 20 * std::log10(amplitude + 1e-12); }

std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder, const std::string& extension) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == extension) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

struct Stereo {
  std::vector<float> left, right;

  [[nodiscard]] double peak() const {
    double peak = 0;
    for (const auto* channel : {&left, &right}) {
      for (const float sample : *channel) peak = std::max(peak, std::abs(static_cast<double>(sample)));
    }
    return peak;
  }
};

// Half a second of the sound of one blow, without a limiter.
Stereo sound_of(const std::filesystem::path& bank, const NoteTable::Strike& blow) {
  constexpr std::size_t kBlock = 256, kFrames = 94 * kBlock;
  Session session(kRate_hz);
  EXPECT_TRUE(session.rack().load("object", bank));
  EXPECT_TRUE(
      session.play(protocol::Strike{{.name = "object"}, {blow.point_m, blow.impulse_ns, blow.contact_time_s}}, 0));
  Stereo sound{std::vector<float>(kFrames), std::vector<float>(kFrames)};
  for (std::size_t at = 0; at < kFrames; at += kBlock) {
    session.rack().mixer().render(synth::Outputs(sound.left.data() + at, sound.right.data() + at), kBlock);
  }
  return sound;
}

// The programs give two blows whose impulse nobody needs to state: that of a key at full velocity, and that of a click
// in the window, which is as strong as the blow whose pressure a recorded bank states.
TEST(PresetLevels, ASingleBlowOnAPresetStaysBelowTheLimiterAndIsHeard) {
  constexpr double kClickContact_s = 0.0005, kLost_db = -60;
  const auto banks = files_below(kPresets / "banks", ".glb");
  EXPECT_GT(banks.size(), 70u);
  for (const auto& bank : banks) {
    Session session(kRate_hz);
    ASSERT_TRUE(session.rack().load("object", bank));
    const NoteTable notes = resolve(std::nullopt, session.rack().objects());
    ASSERT_TRUE(notes.notes[kFirstDefaultNote]);
    const NoteTable::Strike key = *notes.notes[kFirstDefaultNote];
    NoteTable::Strike click = key;
    click.contact_time_s = kClickContact_s;
    click.impulse_ns = (modal::kPeakBlow_ns / length(key.impulse_ns)) * key.impulse_ns;
    const double key_db = decibels(sound_of(bank, key).peak()), click_db = decibels(sound_of(bank, click).peak());
    const std::string name = bank.lexically_relative(kPresets / "banks");
    std::printf("%-24s a key of %7.5f N s peaks at %6.1f dB, a click at %6.1f dB\n", name.c_str(),
                length(key.impulse_ns), key_db, click_db);
    EXPECT_LT(std::max(key_db, click_db), kCeiling_db) << name;
    EXPECT_GT(std::min(key_db, click_db), kLost_db) << name;
  }
}

// A biquad filter, by the coefficients of its transfer function.
void filter(std::vector<double>& samples, const std::array<double, 3>& b, const std::array<double, 3>& a) {
  double first = 0, second = 0;
  for (double& sample : samples) {
    const double in = sample;
    sample = b[0] * in + first;
    first = b[1] * in - a[1] * sample + second;
    second = b[2] * in - a[2] * sample;
  }
}

// Integrated loudness of a stereo sound at 48 kHz [LUFS], by ITU-R BS.1770-4: the mean power of K-weighted blocks of
// 400 ms, every 100 ms, without those below -70 LUFS, and then without those 10 LU below the mean of the rest.
double integrated_lufs(const Stereo& sound) {
  constexpr std::size_t kHop = 4800, kHops = 4;
  std::vector<double> hops(sound.left.size() / kHop);  // energy
  for (const auto* channel : {&sound.left, &sound.right}) {
    std::vector<double> weighted(channel->begin(), channel->end());
    filter(weighted, {1.53512485958697, -2.69169618940638, 1.19839281085285}, {1, -1.69065929318241, 0.73248077421585});
    filter(weighted, {1, -2, 1}, {1, -1.99004745483398, 0.99007225036621});
    for (std::size_t i = 0; i < hops.size() * kHop; ++i) hops[i / kHop] += weighted[i] * weighted[i];
  }
  std::vector<double> powers;
  for (std::size_t i = 0; i + kHops <= hops.size(); ++i) {
    powers.push_back((hops[i] + hops[i + 1] + hops[i + 2] + hops[i + 3]) / (kHops * kHop));
  }
  const auto lufs = [](double power) { return -0.691 + 10 * std::log10(power + 1e-20); };
  const auto mean_above = [&](double gate) {
    double sum = 0, count = 0;
    for (const double power : powers) {
      if (lufs(power) > gate) sum += power, ++count;
    }
    return lufs(count > 0 ? sum / count : 0);
  };
  return mean_above(mean_above(-70) - 10);
}

TEST(PresetLevels, ASineOf997HertzAtMinus23DecibelsInBothChannelsHasMinus23Lufs) {
  Stereo sine;
  for (int n = 0; n < 5 * 48000; ++n) {
    sine.left.push_back(
        static_cast<float>(std::pow(10, -23.0 / 20) * std::sin(2 * std::numbers::pi * 997 * n / kRate_hz)));
  }
  sine.right = sine.left;
  EXPECT_NEAR(integrated_lufs(sine), -23, 0.05);
}

TEST(PresetLevels, PresetScenesDifferByAtMostSixLoudnessUnitsAndStayBelowTheLimiter) {
  double quietest = 0, loudest = -100;
  for (const auto& scene : files_below(kPresets / "scenes", ".toml")) {
    const auto recording = render_offline({.scene = scene}, [](double) { return true; });
    ASSERT_TRUE(recording) << recording.error().message;
    const double lufs = integrated_lufs({recording->left, recording->right});
    const double peak_db = decibels(static_cast<double>(recording->peak));
    std::printf("%-20s %6.1f LUFS, peak %6.1f dB\n", scene.stem().c_str(), lufs, peak_db);
    EXPECT_LT(peak_db, kCeiling_db) << scene;
    quietest = std::min(quietest, lufs);
    loudest = std::max(loudest, lufs);
  }
  EXPECT_LT(loudest - quietest, 6);
}

}  // namespace
}  // namespace ringdown::session
