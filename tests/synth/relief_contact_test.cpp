// Contacts over surfaces whose heights are known: the force is the load times the slope under the contact.
#include "engine/modal/surface_relief.h"
#include "engine/synth/contact/rubbing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace ringdown::synth {
namespace {

constexpr double kRate_hz = 48000, kForce_n = 3;
constexpr std::size_t kFrames = 24000;

modal::SurfaceTrack sine(double wave_m, double height_m) {
  std::vector<float> heights;
  for (int k = 0; k < 6400; ++k)
    heights.push_back(static_cast<float>(height_m * std::sin(2 * std::numbers::pi * k / 64)));
  return modal::SurfaceTrack::make(heights, wave_m / 64).value();
}

std::vector<double> forces(const Contact& contact, std::size_t block = 64) {
  Rubbing rubbing(contact.number, kRate_hz);
  std::vector<double> impulses(kFrames);
  std::size_t updated = 0;
  for (std::size_t done = 0; done < kFrames; done += block) {
    while (updated <= done) rubbing.update(static_cast<Frame>(updated), contact), updated += 240;
    rubbing.fill(static_cast<Frame>(done), std::min(block, kFrames - done), impulses.data() + done);
  }
  for (double& x : impulses) x *= kRate_hz;
  return impulses;
}

// The amplitude of a sine of that frequency in the second half, by its Fourier sum.
double amplitude(const std::vector<double>& samples, double frequency_hz) {
  double c = 0, s = 0;
  for (std::size_t n = kFrames / 2; n < kFrames; ++n) {
    const double turn = 2 * std::numbers::pi * frequency_hz * static_cast<double>(n) / kRate_hz;
    c += samples[n] * std::cos(turn), s += samples[n] * std::sin(turn);
  }
  return 2 * std::hypot(c, s) / (0.5 * kFrames);
}

double rms(const std::vector<double>& samples) {
  double sum = 0;
  for (std::size_t n = kFrames / 2; n < kFrames; ++n) sum += samples[n] * samples[n];
  return std::sqrt(sum / (0.5 * kFrames));
}

Contact over(const modal::SurfaceRelief* first, double first_m_s, const modal::SurfaceRelief* second = nullptr,
             double second_m_s = 0) {
  Contact contact{.force_n = {0, 0, kForce_n}, .slip_m_s = 0.1};
  contact.surfaces = {Passing{first, first_m_s}, Passing{second, second_m_s}};
  return contact;
}

TEST(ReliefContact, AProfileSoundsInPlaceOfTheRandomFinish) {
  constexpr double kWave_m = 4e-4, kHeight_m = 2e-6, kSpeed_m_s = 0.2;
  const modal::SurfaceRelief relief{.profile = sine(kWave_m, kHeight_m)};
  const auto heard = forces(over(&relief, kSpeed_m_s));
  const double expected_n = kForce_n * kHeight_m * 2 * std::numbers::pi / kWave_m;
  EXPECT_NEAR(amplitude(heard, kSpeed_m_s / kWave_m) / expected_n, 1, 0.01);
  EXPECT_NEAR(rms(heard) * std::sqrt(2.0) / expected_n, 1, 0.01) << "nothing else sounds";
}

TEST(ReliefContact, EachSurfacePassesAtItsOwnSpeed) {
  constexpr double kWave_m = 4e-4;
  const modal::SurfaceRelief a{.profile = sine(kWave_m, 2e-6)}, b{.profile = sine(kWave_m, 1e-6)};
  const auto heard = forces(over(&a, 0.2, &b, 0.08));
  const double per_height = kForce_n * 2 * std::numbers::pi / kWave_m;
  EXPECT_NEAR(amplitude(heard, 500) / (2e-6 * per_height), 1, 0.02);
  EXPECT_NEAR(amplitude(heard, 200) / (1e-6 * per_height), 1, 0.02);
  const auto resting = forces(over(&a, 0, &b, 0.08));
  EXPECT_LT(amplitude(resting, 500), 0.01 * 2e-6 * per_height) << "a surface that is not travelled over";
}

TEST(ReliefContact, MesoscaleReliefAddsToTheFinish) {
  const modal::SurfaceRelief tiles{.mesoscale = sine(2e-3, 1e-4)};
  Contact plain = over(nullptr, 0), tiled = over(&tiles, 0.4);
  const auto without = forces(plain), with = forces(tiled);
  std::vector<double> difference(kFrames);
  for (std::size_t n = 0; n < kFrames; ++n) difference[n] = with[n] - without[n];
  EXPECT_GT(rms(without), 0);
  EXPECT_NEAR(amplitude(difference, 200) / (kForce_n * 1e-4 * 2 * std::numbers::pi / 2e-3), 1, 0.02);
  EXPECT_NEAR(rms(difference) * std::sqrt(2.0) / amplitude(difference, 200), 1, 0.02);
}

TEST(ReliefContact, WavesShorterThanTheContactAreNotFelt) {
  constexpr double kWave_m = 4e-4;
  const modal::SurfaceRelief relief{.profile = sine(kWave_m, 2e-6)};
  Contact wide = over(&relief, 0.2);
  wide.finish_width_m = 10 * kWave_m;
  EXPECT_LT(rms(forces(wide)), 0.03 * rms(forces(over(&relief, 0.2))));
}

TEST(ReliefContact, BlocksDoNotChangeTheForce) {
  const modal::SurfaceRelief relief{.profile = sine(3e-4, 2e-6), .mesoscale = sine(3e-3, 1e-5)};
  const auto even = forces(over(&relief, 0.2), 64), odd = forces(over(&relief, 0.2), 37);
  double max = 0;
  for (std::size_t n = 0; n < kFrames; ++n) max = std::max(max, std::abs(even[n] - odd[n]));
  EXPECT_LT(max, 1e-5 * rms(even));
}

TEST(ReliefContact, AShortestWavelengthEndsTheRandomFinish) {
  const auto crossings = [](double shortest_m) {
    Contact contact{.force_n = {0, 0, kForce_n}, .slip_m_s = 0.004};
    contact.texture.shortest_m = shortest_m;
    const auto heard = forces(contact);
    int count = 0;
    for (std::size_t n = kFrames / 2 + 1; n < kFrames; ++n) count += heard[n - 1] < 0 && heard[n] >= 0 ? 1 : 0;
    return count;
  };
  const Contact usual{.force_n = {0, 0, kForce_n}, .slip_m_s = 0.004};
  Contact same = usual;
  same.texture.shortest_m = same.texture.correlation_m / 16;
  EXPECT_EQ(forces(usual), forces(same)) << "a sixteenth of the longest is the default";
  EXPECT_LT(2 * crossings(5e-5), crossings(5e-5 / 16));
  EXPECT_GT(crossings(5e-5 / 256), crossings(5e-5 / 16));
}

}  // namespace
}  // namespace ringdown::synth
