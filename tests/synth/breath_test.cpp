// The air in an object: a slap and breath on its mouth, against one oscillator in closed form.
#include "tests/synth/player.h"

namespace ringdown::synth::test {
namespace {

constexpr double kArea_m2 = std::numbers::pi / 4 * kMouth_m * kMouth_m;

double power(std::span<const double> samples) {
  double sum = 0;
  for (const double x : samples) sum += x * x;
  return sum / static_cast<double>(samples.size());
}

TEST(Breath, SlapIsAPulseOnTheAirAndDecaysWithIt) {
  Player player;
  player.install(0, map_of(vessel_bank()));
  player.push({0, 0, verb::Slap{1e-3, 0}});
  player.render(24000);
  EXPECT_LT(
      relative_error_db(player.left, closed_form(kAir_hz, kAirDecay_per_s, 1e-3 * kFlux / kArea_m2, 0, kRate, 24000)),
      -90);
}

TEST(Breath, LongSlapIsSoftAsItsSpectrumSays) {
  Player player;
  player.install(0, map_of(vessel_bank()));
  player.push({0, 0, verb::Slap{1e-3, 0.004}});
  player.render(24000);
  const DampedSinusoid tail = fit_damped_sinusoid(player.left_from(1000), kRate);
  const double pulse = static_cast<double>(pulse_factor(kAir_hz, 0.004L));
  const double start = tail.amplitude() * std::exp(kAirDecay_per_s * 1000 / kRate);
  const double wanted =
      kLoudness * 2 * std::numbers::pi * kAir_hz * 1e-3 * kFlux / kArea_m2 * pulse / std::numbers::sqrt2;
  EXPECT_NEAR(start / wanted, 1, 0.01);
  EXPECT_NEAR(tail.decay_per_s, kAirDecay_per_s, 0.01);
}

// White noise of mean square p^2 from 20 to 10,240 Hz has a density of S = p^2 / 10,220 Hz. It drives the modal
// velocity by flux times p, whose mean square becomes flux^2 S / (8 d).
TEST(Breath, BlowIsStationaryAtTheLevelOfAnOscillatorInNoiseAndStops) {
  constexpr double kPressure_pa = 50;
  constexpr std::size_t kSecond = 48000, kLast = 20 * kSecond;
  Player player;
  player.install(0, map_of(vessel_bank()));
  player.push({0, 0, verb::Blow{kPressure_pa}});
  player.push({static_cast<Frame>(kLast), 0, verb::Blow{0}});
  player.render(kLast + kSecond);
  const std::span<const double> all = player.left;
  const double early = power(all.subspan(kSecond, 9 * kSecond)), late = power(all.subspan(10 * kSecond, 9 * kSecond));
  EXPECT_NEAR(10 * std::log10(late / early), 0, 2.5);
  const double omega = 2 * std::numbers::pi * kAir_hz, density = kPressure_pa * kPressure_pa / 10220;
  const double velocity = kFlux * std::sqrt(density / (8 * kAirDecay_per_s));
  const double wanted = kLoudness * omega * velocity / std::numbers::sqrt2;
  std::printf("blow: %.2f dB beside white noise, late over early %.2f dB\n",
              10 * std::log10((early + late) / 2 / (wanted * wanted)), 10 * std::log10(late / early));
  EXPECT_NEAR(10 * std::log10((early + late) / 2 / (wanted * wanted)), 0, 2.5);
  const DampedSinusoid tail = fit_damped_sinusoid(all.subspan(kLast + 1000, 12000), kRate);
  EXPECT_NEAR(tail.frequency_hz, kAir_hz, 0.02);
  EXPECT_NEAR(tail.decay_per_s, kAirDecay_per_s, 0.05);
}

TEST(Breath, ClearEndsIt) {
  Player player;
  player.install(0, map_of(vessel_bank()));
  player.push({0, 0, verb::Blow{50}});
  player.push(clear_at(24000, 0));
  player.render(48000);
  EXPECT_GT(power(player.left_from(20000).first(4000)), 0);
  EXPECT_EQ(peak(player.left_from(40000)), 0);
}

TEST(Breath, ObjectWithoutAirAndAbsurdPressuresAreRefused) {
  Player player;
  player.install(0, map_of(single_mode_bank(1000, 3)));
  player.install(1, map_of(vessel_bank()));
  player.push({0, 0, verb::Slap{1}});
  player.push({0, 0, verb::Blow{50}});
  player.push({0, 1, verb::Blow{-1}});
  player.push({0, 1, verb::Blow{std::nan("")}});
  player.push({0, 1, verb::Blow{1e30}});
  player.render(2000);
  EXPECT_EQ(player.mixer.counters().refused, 5u);
  EXPECT_EQ(peak(player.left), 0);
}

TEST(Breath, ObjectOfTwiceTheSizeTakesTheSamePressureOnFourTimesTheArea) {
  for (const double size : {1.0, 2.0}) {
    const modal::MaterialScale material{.size = size};
    Player slapped, blown;
    slapped.install(0, map_of(vessel_bank()), Mixer::Install::replace, material);
    slapped.push({0, 0, verb::Slap{1e-3, 0}});
    slapped.render(4800);
    const DampedSinusoid ring = fit_damped_sinusoid(slapped.left, kRate);
    blown.install(0, map_of(vessel_bank()), Mixer::Install::replace, material);
    blown.push({0, 0, verb::Blow{50}});
    blown.render(480000);
    // A slap of J is a pressure of J/A: v^2 of the noise over the slap's is p^2 A^2 / (J^2 10,220 Hz 8 d).
    const double force_n = 50 * size * size * kArea_m2, level = force_n / 1e-3 * ring.amplitude();
    const double wanted = level * level / (10220 * 8 * ring.decay_per_s);
    EXPECT_NEAR(10 * std::log10(power(blown.left_from(48000)) / wanted), 0, 3) << size;
  }
}

}  // namespace
}  // namespace ringdown::synth::test
