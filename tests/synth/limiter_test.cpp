// The limiter: no sample passes the ceiling, and below it nothing happens.
#include "engine/synth/output/limiter.h"

#include "tests/support/realtime_guard.h"
#include "tests/synth/player.h"

#include <cmath>
#include <limits>
#include <random>

namespace ringdown::synth::test {
namespace {

struct Stereo {
  std::vector<float> left, right;
};

Stereo mono(std::vector<float> samples) { return {samples, samples}; }

// In blocks of the given sizes, over and over.
Stereo limited(Limiter& limiter, Stereo signal, const std::vector<std::size_t>& blocks = {128}) {
  for (std::size_t done = 0, i = 0; done < signal.left.size(); ++i) {
    const std::size_t now = std::min(blocks[i % blocks.size()], signal.left.size() - done);
    limiter.process(signal.left.data() + done, signal.right.data() + done, now);
    done += now;
  }
  return signal;
}

float highest(const Stereo& signal) {
  float max = 0;
  for (const auto* channel : {&signal.left, &signal.right}) {
    for (const float sample : *channel) max = std::max(max, std::abs(sample));
  }
  return max;
}

std::vector<float> sine(double amplitude, double frequency_hz, std::size_t count) {
  std::vector<float> samples(count);
  for (std::size_t n = 0; n < count; ++n) {
    samples[n] =
        static_cast<float>(amplitude * std::sin(2 * std::numbers::pi * frequency_hz * static_cast<double>(n) / kRate));
  }
  return samples;
}

// Whether `signal` is `original`, `delay` frames later, bit by bit, from frame `from` on.
bool is_delayed(const std::vector<float>& signal, const std::vector<float>& original, std::size_t delay,
                std::size_t from = 0) {
  for (std::size_t n = from; n < signal.size(); ++n) {
    if (signal[n] != (n < delay ? 0.0f : original[n - delay])) return false;
  }
  return true;
}

// Noise whose level jumps, single samples, steps, and what is not a number.
Stereo hostile_signal(std::mt19937& random, std::size_t count) {
  Stereo signal{std::vector<float>(count), std::vector<float>(count)};
  const auto uniform = [&random] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  double level = 1;
  for (std::size_t n = 0; n < count; ++n) {
    if (random() % 200 == 0) level = std::pow(10.0, 9 * uniform());
    for (auto* channel : {&signal.left, &signal.right}) {
      const auto kind = random() % 1000;
      (*channel)[n] = kind == 0   ? std::numeric_limits<float>::quiet_NaN()
                      : kind == 1 ? std::numeric_limits<float>::infinity()
                      : kind == 2 ? std::numeric_limits<float>::max()
                      : kind < 50 ? static_cast<float>(level)
                                  : static_cast<float>(level * uniform());
    }
  }
  return signal;
}

TEST(Limiter, NoSampleEverPassesTheCeiling) {
  std::mt19937 random(3);
  for (const double rate : {8000.0, 44100.0, 48000.0, 768000.0}) {
    for (const double ceiling_db : {0.0, -1.0, -23.7, -60.0}) {
      Limiter limiter(rate, ceiling_db);
      EXPECT_LE(limiter.ceiling(), std::pow(10.0, ceiling_db / 20));
      const Stereo out = limited(limiter, hostile_signal(random, 50000), {1, 128, 7, 8192, 64, 1000});
      EXPECT_LE(highest(out), limiter.ceiling());
      EXPECT_GT(highest(out), 0.0f);
    }
  }
}

TEST(Limiter, ALoudSoundIsTurnedDownToTheCeilingAndNoFurther) {
  Limiter limiter(kRate, -3);
  EXPECT_GT(highest(limited(limiter, mono(sine(20, 997, 9600)))), 0.999f * limiter.ceiling());
}

TEST(Limiter, OnePeakBeforeAnotherIsMetAsWell) {
  // Each distance of two peaks, the louder first and last.
  for (std::size_t distance = 1; distance < 210; ++distance) {
    for (const float first : {1.5f, 30.0f}) {
      Limiter limiter(kRate, 0);
      std::vector<float> signal(1000, 0.9f);
      signal[300] = first;
      signal[300 + distance] = -6;
      EXPECT_LE(highest(limited(limiter, mono(signal))), 1.0f) << distance;
    }
  }
}

TEST(Limiter, BelowTheCeilingSamplesAreOnlyDelayed) {
  Limiter limiter(kRate, -6);
  const std::vector<float> loudest = sine(limiter.ceiling(), 997, 48000);
  EXPECT_TRUE(is_delayed(limited(limiter, mono(loudest)).left, loudest, limiter.delay_frames()));
  EXPECT_NEAR(static_cast<double>(limiter.delay_frames()), Limiter::kLookAhead_s * kRate, 2);
}

TEST(Limiter, TheLimiterIsOnlyADelayAgainAfterAPeak) {
  Limiter limiter(kRate, 0);
  std::vector<float> signal = sine(0.5, 441, 144000);
  signal[1000] = 100;
  const Stereo out = limited(limiter, mono(signal));
  EXPECT_FALSE(is_delayed(out.left, signal, limiter.delay_frames()));
  EXPECT_TRUE(is_delayed(out.left, signal, limiter.delay_frames(), 96000));
}

TEST(Limiter, BothChannelsGetOneGain) {
  std::mt19937 random(4);
  Limiter limiter(kRate, 0);
  Stereo signal;
  for (int n = 0; n < 20000; ++n) {
    const auto sample = static_cast<float>(static_cast<double>(random()) / 4294967296.0 * (n % 3000));
    signal.left.push_back(sample);
    signal.right.push_back(-0.25f * sample);
  }
  const Stereo out = limited(limiter, signal);
  for (std::size_t n = 0; n < out.left.size(); ++n) EXPECT_EQ(out.right[n], -0.25f * out.left[n]);
}

TEST(Limiter, TheGainMovesWithoutSteps) {
  Limiter limiter(kRate, 0);
  std::vector<float> signal(24000, 1.0f);
  signal[12000] = 10;
  const std::vector<float> gain = limited(limiter, mono(signal)).left;
  EXPECT_LE(*std::min_element(gain.begin() + 11000, gain.end()), 0.1001f);
  const double ramp = static_cast<double>(limiter.delay_frames()) / 2;
  for (std::size_t n = 200; n + 1 < gain.size(); ++n) {
    if (n == 12000 + limiter.delay_frames() || n + 1 == 12000 + limiter.delay_frames()) continue;  // the peak itself
    if (n - 1 == 12000 + limiter.delay_frames()) continue;
    const double before = gain[n - 1], now = gain[n], after = gain[n + 1];
    ASSERT_LE(std::abs(after - now), 1.0 / ramp) << n;
    ASSERT_LE(std::abs(after - 2 * now + before), 1.1 / (ramp * ramp)) << n;
  }
}

TEST(Limiter, BlocksOfAnySizeSoundTheSame) {
  std::mt19937 random(5);
  const Stereo signal = hostile_signal(random, 30000);
  Limiter one(kRate, -1), other(kRate, -1);
  const Stereo a = limited(one, signal, {256}), b = limited(other, signal, {1, 33, 8192, 100});
  EXPECT_EQ(a.left, b.left);
  EXPECT_EQ(a.right, b.right);
}

TEST(Limiter, TheLimiterDoesNothingThatAnAudioThreadMustNot) {
  std::mt19937 random(6);
  Stereo signal = hostile_signal(random, 4096);
  Limiter limiter(kRate, -1);
  const RealtimeScope scope;
  limiter.process(signal.left.data(), signal.right.data(), signal.left.size());
  EXPECT_EQ(scope.seen().total(), 0u) << scope.seen().first;
}

Samples played(double impulse_ns, std::optional<double> ceiling_db) {
  Player player;
  set(player.mixer, &MixerSettings::limiter_db, ceiling_db);
  const Map map = map_of(single_mode_bank(440, 5));
  player.install(0, map);
  player.push(strike_at(100, 0, {0, 0, impulse_ns}));
  player.render(24000);
  return player.left;
}

TEST(MixerLimiter, TheLimiterOfAQuietMixIsADelayBitByBit) {
  const Samples plain = played(0.1, std::nullopt), late = played(0.1, -1);
  const std::size_t delay = Limiter(kRate, -1).delay_frames();
  ASSERT_GT(peak(plain), 0.01);
  ASSERT_LT(peak(plain), 0.8);
  EXPECT_TRUE(std::equal(plain.begin(), plain.end() - static_cast<std::ptrdiff_t>(delay),
                         late.begin() + static_cast<std::ptrdiff_t>(delay)));
}

TEST(MixerLimiter, TheLimiterHoldsALoudMixAtTheCeilingAndSaysSo) {
  EXPECT_GT(peak(played(100, std::nullopt)), 10);
  EXPECT_LE(peak(played(100, -1)), std::pow(10.0, -1.0 / 20));
  EXPECT_GT(peak(played(100, -1)), 0.85);
  Mixer mixer(kRate);
  EXPECT_EQ(mixer.latency_frames(), 0u);
  set(mixer, &MixerSettings::limiter_db, -1);
  EXPECT_EQ(mixer.latency_frames(), Limiter(kRate, -1).delay_frames());
}

TEST(MixerLimiter, TheLimiterLeavesBusesAsTheyAre) {
  std::vector<float> bus[2];
  for (int limit = 0; limit < 2; ++limit) {
    Player player;
    if (limit == 1) set(player.mixer, &MixerSettings::limiter_db, -20);
    player.install(0, map_of(single_mode_bank(440, 5)));
    ASSERT_TRUE(player.mixer.assign(0, 3));
    player.push(strike_at(0, 0, {0, 0, 10}));
    std::vector<float> left(4800), right(4800);
    bus[limit].resize(4800);
    Outputs outputs(left.data(), right.data());
    outputs.listen_to_bus(3, bus[limit].data());
    player.mixer.render(outputs, 4800);
  }
  EXPECT_EQ(bus[0], bus[1]);
  EXPECT_GT(highest(mono(bus[0])), 1.0f);
}

}  // namespace
}  // namespace ringdown::synth::test
