// Pitches of the mixer against the full nonlinear equations, for a thin steel plate.
#include "tests/bake/struck_plate.h"

#include <complex>
#include <utility>

namespace ringdown::synth::test {
namespace {

// The frequency at which a Hann window of the second half hears most, near `guess_hz`.
double pitch_hz(const Samples& sound, double guess_hz) {
  const std::size_t first = sound.size() / 5, count = sound.size() - first;
  const auto power = [&](double hz) {
    std::complex<double> sum;
    const std::complex<double> turn = std::polar(1.0, -2 * std::numbers::pi * hz / kRate_hz);
    std::complex<double> at = 1;
    for (std::size_t n = 0; n < count; ++n, at *= turn) {
      const double window = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * static_cast<double>(n) / count);
      sum += window * sound[first + n] * at;
    }
    return std::norm(sum);
  };
  double best = guess_hz;
  for (double hz = 0.985 * guess_hz; hz < 1.16 * guess_hz; hz += 1) best = power(hz) > power(best) ? hz : best;
  for (double step = 0.5; step > 0.01; step /= 2) {
    for (const double hz : {best - step, best + step}) best = power(hz) > power(best) ? hz : best;
  }
  return best;
}

Samples by_moments(Voice& voice, std::size_t frames) {
  Samples sound;
  const auto synthesis = std::make_unique<MomentSynthesis>();
  const auto sums = std::make_unique<MomentSums>(), silent = std::make_unique<MomentSums>();
  while (sound.size() < frames) {
    std::array<double, kChunkFrames> out{}, ignored{};
    sums->of.fill(0), silent->of.fill(0);
    const MomentTarget target{sums.get(), 1, 0};
    EXPECT_TRUE(voice.render_moments({&target, 1}, out.data(), kChunkFrames, 1e-12));
    synthesis->add(*sums, *silent, out.data(), ignored.data(), kChunkFrames);
    sound.insert(sound.end(), out.begin(), out.end());
  }
  return sound;
}

double cents(double hz, double from_hz) { return 1200 * std::log2(hz / from_hz); }

// Struck to `impulse_ns`: the three lowest modes' pitches within `allowed` cents of the equations'.
void expect_pitches(const Plate& plate, double impulse_ns, double peak, double allowed) {
  double peak_m = 0;
  const std::vector<Samples> exact = integrated(plate, impulse_ns, peak_m);
  const std::size_t frames = exact[0].size();
  EXPECT_NEAR(peak_m / kThickness_m, peak, 0.1 * peak);
  const Samples tables = by_tables(*struck(plate, true, impulse_ns), frames);
  const Samples moments = by_moments(*struck(plate, true, impulse_ns), frames);
  for (int m = 0; m < 3; ++m) {
    const double own_hz = plate.omega[m] / (2 * std::numbers::pi), wanted_hz = pitch_hz(exact[m], own_hz);
    EXPECT_LT(std::abs(cents(pitch_hz(tables, own_hz), wanted_hz)), allowed)
        << "mode " << m << " glides by " << cents(wanted_hz, own_hz);
    EXPECT_LT(std::abs(cents(pitch_hz(moments, own_hz), wanted_hz)), allowed) << "mode " << m << " by moments";
  }
}

TEST(Glide, FollowsTheFullEquationsToHalfAThickness) { expect_pitches(steel_plate(), 0.058, 0.5, 5); }
TEST(Glide, FollowsTheFullEquationsToTwoThirdsOfAThickness) { expect_pitches(steel_plate(), 0.077, 0.65, 10); }

// Amplitudes are those of the linear voice; only phases differ.
TEST(Glide, KeepsEveryModesEnergy) {
  const Plate plate = steel_plate();
  const auto gliding = struck(plate, true, 0.36), linear = struck(plate, false, 0.36);
  by_tables(*gliding, 24000), by_tables(*linear, 24000);
  EXPECT_NEAR(gliding->peak_level(0) / linear->peak_level(0), 1, 1e-9);
}

TEST(Glide, ASoftBlowSoundsAsWithoutTermsToTheLastBit) {
  const Plate plate = steel_plate();
  EXPECT_EQ(by_tables(*struck(plate, true, 1e-5), 4096), by_tables(*struck(plate, false, 1e-5), 4096));
  EXPECT_EQ(by_moments(*struck(plate, true, 1e-5), 4096), by_moments(*struck(plate, false, 1e-5), 4096));
}

// A mode's pitch depends on all that ring, heard or not.
TEST(Glide, AModeThatRadiatesNothingDetunesTheOthers) {
  const Plate plate = steel_plate();
  const auto pitch = [&](bool heard) {
    modal::Bank bank = map_of(plate, true)->bank();
    modal::BankRadiation radiation;
    radiation.maps.modes.assign(bank.mode_count(), {.wavenumber_rad_m = 1, .terms = {{0, 1.0F}}});
    if (!heard) radiation.maps.modes[0].terms.clear();
    bank.radiation = radiation;
    Voice voice(std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(std::move(bank))),
                modal::MaterialScale{}, kRate_hz);
    EXPECT_TRUE(voice.strike(verb::StrikeVertex{.vertex = 0, .impulse_ns = {0, 0, 0.077}, .contact_time_s = 0}));
    const double own_hz = plate.omega[1] / (2 * std::numbers::pi);
    return cents(pitch_hz(by_tables(voice, 24000), own_hz), own_hz);
  };
  const double wanted = pitch(true);
  EXPECT_GT(wanted, 10);
  EXPECT_NEAR(pitch(false), wanted, 0.1);
}

// An object of twice the size glides as much when it is struck to as many thicknesses: impulse times size^3.
TEST(Glide, ScalesWithSizeAndMaterial) {
  const Plate plate = steel_plate();
  const auto pitch = [&](const modal::MaterialScale& scale, double impulse_ns) {
    Voice voice(map_of(plate, true), scale, kRate_hz);
    EXPECT_TRUE(voice.strike(verb::StrikeVertex{.vertex = 0, .impulse_ns = {0, 0, impulse_ns}, .contact_time_s = 0}));
    const double own_hz = plate.omega[0] / (2 * std::numbers::pi) * std::sqrt(modal::lambda_factor(scale));
    return cents(pitch_hz(by_tables(voice, 24000), own_hz), own_hz);
  };
  const double as_baked = pitch({}, 0.3);
  EXPECT_GT(as_baked, 10);
  EXPECT_NEAR(pitch({.stiffness = 2, .size = 2}, 0.3 * 8 * std::sqrt(2.0)), as_baked, 3);
  EXPECT_NEAR(pitch({.density = 2}, 0.3 * std::sqrt(2.0)), as_baked, 1);
}

}  // namespace
}  // namespace ringdown::synth::test
