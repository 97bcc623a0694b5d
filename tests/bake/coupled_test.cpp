// Modes that exchange energy: conservation over a million steps, the full equations as oracle, no clicks.
#include "engine/synth/modes/coupled_modes.h"
#include "tests/bake/sound_centroid.h"
#include "tests/bake/struck_plate.h"

#include <algorithm>
#include <cstdio>

namespace ringdown::synth::test {
namespace {

// The coupled modes alone, struck by `impulse_ns`.
struct Rig {
  Rig(const Plate& plate, double impulse_ns, double decay_per_s)
      : table(map_of(plate, true, kModes, decay_per_s), modal::MaterialScale{}, kRate_hz),
        modes(*table.coupled),
        re(table.columns()),
        im(table.columns()) {
    strike(impulse_ns);
  }
  void strike(double impulse_ns) {
    std::vector<double> scratch(kModes);
    auto amplitudes = aligned_zeros<double>(table.columns());
    const verb::StrikeVertex blow{.impulse_ns = {0, 0, impulse_ns}, .contact_time_s = 0};
    ASSERT_TRUE(table.strike(blow, scratch, amplitudes.get()));
    for (std::size_t c = 0; c < table.columns(); ++c) im[c] -= amplitudes.get()[c];
    modes.take(re.data(), im.data());
  }
  void render(int frames) {
    for (; frames > 0; frames -= 128) {
      std::array<double, 128> out{};
      ASSERT_TRUE(modes.render(out.data(), out.size()));
    }
  }
  ModeTable table;
  CoupledModes modes;
  std::vector<double> re, im;
};

double drift(const Plate& plate, double impulse_ns) {
  Rig rig(plate, impulse_ns, 0);
  const double before = rig.modes.energy_j();
  double worst = 0;
  for (int block = 0; block < 100; ++block) {
    rig.render(10'112);
    worst = std::max(worst, std::abs(rig.modes.energy_j() / before - 1));
  }
  return worst;
}

TEST(CoupledModes, AMillionLosslessStepsKeepTheEnergy) {
  Plate plate = steel_plate();
  EXPECT_LT(drift(plate, 0.12), 1e-10);
  plate.curving = 0.1;
  EXPECT_LT(drift(plate, 0.12), 1e-10);
}

TEST(CoupledModes, EnergyNeverRisesBetweenBlowsAndPsiStaysTrue) {
  for (const double impulse_ns : {0.05, 0.12, 0.36}) {
    Rig rig(steel_plate(), impulse_ns, 2);
    double last = rig.modes.energy_j();
    for (int blow = 0; blow < 3; ++blow) {
      for (int chunk = 0; chunk < 100; ++chunk) {
        rig.render(128);
        const double energy = rig.modes.energy_j();
        EXPECT_LE(energy, last * (1 + 1e-12));
        last = energy;
        EXPECT_NEAR(rig.modes.psi_over_truth(), 1, 0.05) << impulse_ns << " N s";
      }
      rig.strike(impulse_ns);
      last = rig.modes.energy_j();
    }
  }
}

// Twenty milliseconds after a blow to a whole thickness the motion is still that of the equations, wave for wave.
TEST(CoupledModes, SoundAsTheFullEquations) {
  const Plate plate = steel_plate();
  double peak_m = 0;
  const double impulse_ns = 0.12;
  const std::vector<Samples> exact = integrated(plate, impulse_ns, peak_m);
  EXPECT_GT(peak_m, 0.9 * kThickness_m);
  Rig rig(plate, impulse_ns, kDecay_per_s);
  double wrong = 0, right = 0;
  std::vector<double> re(rig.re.size()), im(rig.re.size());
  for (int chunk = 0; chunk < 8; ++chunk) {
    rig.render(128);
    // The velocity of a mode, from its state: -(Im z omega_d + d Re z) over its output per displacement.
    rig.modes.give_back(re.data(), im.data());
    for (int m = 0; m < kModes; ++m) {
      const std::size_t c = *rig.table.column_of(static_cast<std::size_t>(m));
      const auto& columns = rig.table.coupled->columns;
      const auto place = std::find(columns.begin(), columns.end(), c) - columns.begin();
      const double output = rig.table.coupled->output[static_cast<std::size_t>(place)];
      const double v = -(im[c] * plate.omega[m] + kDecay_per_s * re[c]) / output, wanted = exact[m][128 * (chunk + 1)];
      wrong += (v - wanted) * (v - wanted);
      right += wanted * wanted;
    }
    rig.modes.take(re.data(), im.data());
  }
  EXPECT_LT(std::sqrt(wrong / right), 0.05);
}

// A blow of one thickness on forty modes, against the full equations at 192 kHz.
TEST(CoupledModes, TheCentroidIsThatOfTheFullEquationsOverHalfASecond) {
  constexpr int kMany = 40;
  const Plate plate = steel_plate(kMany, 30);
  double peak_m = 0;
  const double impulse_ns = 0.1;
  Samples wanted;
  static_cast<void>(integrated(plate, impulse_ns, peak_m, 4, &wanted));
  EXPECT_NEAR(peak_m / kThickness_m, 1, 0.2);
  const auto gliding = struck(plate, true, impulse_ns), coupled = struck(plate, true, impulse_ns, kMany);
  const std::vector<double> of_equations = centroids(wanted);
  const std::vector<double> of_coupled = centroids(by_tables(*coupled, wanted.size()));
  const std::vector<double> of_gliding = centroids(by_tables(*gliding, wanted.size()));
  double worst = 0, worst_gliding = 0;
  for (std::size_t i = 0; i < of_equations.size(); ++i) {
    worst = std::max(worst, std::abs(of_coupled[i] / of_equations[i] - 1));
    worst_gliding = std::max(worst_gliding, std::abs(of_gliding[i] / of_equations[i] - 1));
  }
  std::printf("centroid: %.1f %% off, gliding only %.1f %%\n", 100 * worst, 100 * worst_gliding);
  EXPECT_LT(worst, 0.03);
  EXPECT_GT(worst_gliding, 2 * worst) << "modes that only glide do not exchange energy";
}

// A shell that vibrates is bent inward on average, which no one hears: what sounds is acceleration, whose mean is the
// change of speed over the time.
TEST(CoupledModes, AShellThatItsVibrationBendsSoundsNoConstant) {
  Plate plate = steel_plate();
  plate.curving = 0.1;
  const Samples sound = by_tables(*struck(plate, true, 0.12, kModes), 24'000);
  double sum = 0, squares = 0;
  for (const double sample : sound) sum += sample, squares += sample * sample;
  const double mean = sum / static_cast<double>(sound.size()),
               rms = std::sqrt(squares / static_cast<double>(sound.size()));
  EXPECT_GT(rms, 0);
  EXPECT_LT(std::abs(mean), 1e-3 * rms);
}

// What lies above all modes: a click would be there.
double above_modes(const Samples& sound, std::size_t begin, std::size_t end) {
  double sum = 0;
  for (std::size_t n = begin + 4; n < end; ++n) {  // a fourth difference: 12 dB an octave and octave again
    const double d = sound[n] - 4 * sound[n - 1] + 6 * sound[n - 2] - 4 * sound[n - 3] + sound[n - 4];
    sum = std::max(sum, std::abs(d));
  }
  return sum;
}

TEST(CoupledModes, AVoiceEntersAndLeavesWithoutAClick) {
  const Plate plate = steel_plate();
  const auto coupled = struck(plate, true, 0.03, kModes), gliding = struck(plate, true, 0.03);
  const Samples sound = by_tables(*coupled, 240'000), smooth = by_tables(*gliding, 240'000);
  for (std::size_t begin = 0; begin < 239'000; begin += 1000)
    EXPECT_LT(above_modes(sound, begin, begin + 1000), 1.5 * above_modes(smooth, begin, begin + 1000)) << begin;
}

TEST(CoupledModes, ABlowBeginsThemAndCalmEndsThem) {
  const ModeTable table(map_of(steel_plate(), true, kModes, 5), modal::MaterialScale{}, kRate_hz);
  Coupling coupling(table);
  std::vector<double> re(table.columns()), im(table.columns()), scratch(kModes);
  auto amplitudes = aligned_zeros<double>(table.columns());
  std::array<double, 128> out{};
  const auto outcome = [&] { return coupling.render(re.data(), im.data(), true, out.data(), out.size()); };
  EXPECT_EQ(outcome(), Coupling::Outcome::nothing);
  const verb::StrikeVertex blow{.impulse_ns = {0, 0, 0.06}, .contact_time_s = 0};
  ASSERT_TRUE(table.strike(blow, scratch, amplitudes.get()));
  for (std::size_t c = 0; c < table.columns(); ++c) im[c] -= amplitudes.get()[c];
  int chunks = 0;
  while (outcome() == Coupling::Outcome::rendered && chunks < 2000) ++chunks;
  EXPECT_GT(chunks, 50);
  EXPECT_LT(chunks, 2000);
  EXPECT_FALSE(coupling.running());
  EXPECT_NE(im[*table.column_of(0)], 0) << "the states have what was left";
  EXPECT_EQ(outcome(), Coupling::Outcome::nothing);
}

}  // namespace
}  // namespace ringdown::synth::test
