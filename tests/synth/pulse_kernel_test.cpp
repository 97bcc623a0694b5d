// The spectrum of a blow's pulse against its closed form in long double.
#include "engine/synth/kernels/aligned_array.h"
#include "engine/synth/kernels/mode_kernel.h"
#include "engine/synth/kernels/pulse_kernel.h"
#include "tests/synth/every_instruction_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace ringdown::synth {
namespace {

// cos(pi/2 x) / (1 - x^2) with x = 2 f tau. About x = 1 both vanish, and with y = x - 1 it is
// sin(pi/2 y) / (y (2 + y)).
long double spectrum(long double x) {
  constexpr long double kHalfPi = std::numbers::pi_v<long double> / 2;
  const long double y = x - 1;
  if (std::abs(y) < 1e-9L) return kHalfPi / (2 + y);
  if (std::abs(y) < 1) return std::sin(kHalfPi * y) / (y * (2 + y));
  return std::cos(kHalfPi * std::fmod(x, 4.0L)) / (1 - x * x);
}

TEST(PulseKernel, AmplitudesAreShapedByTheSpectrumOfAHalfSineOnEveryInstructionSet) {
  constexpr double kContact_frames = 1000;
  const double x_per_omega = kContact_frames / std::numbers::pi;
  std::vector<double> wanted_x = {0, 1e-9,     0.5, 1,   1 + 1e-15, 1 - 1e-15, 1 + 1e-7,
                                  2, 2 + 1e-9, 3,   3.5, 4,         6,         1e5 + 0.3};
  for (double x = 0.01; x < 1000; x *= 1.03) wanted_x.push_back(x);
  while (wanted_x.size() % kModePadding != 0) wanted_x.push_back(0);
  const std::size_t count = wanted_x.size();
  const AlignedArray<double> omega = aligned_zeros<double>(count);
  for (std::size_t i = 0; i < count; ++i) omega[i] = wanted_x[i] / x_per_omega;
  test::on_every_instruction_set([&](const char* name) {
    const AlignedArray<double> amplitudes = aligned_zeros<double>(count);
    for (std::size_t i = 0; i < count; ++i) amplitudes[i] = -2;
    const double energy = shape_by_pulse(omega.get(), count, kContact_frames, amplitudes.get());
    long double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      // The rounding of x itself counts beside the pole and in the side lobes, whose slope is below 2 / x.
      const long double x = static_cast<long double>(omega[i]) * static_cast<long double>(x_per_omega);
      EXPECT_NEAR(amplitudes[i], static_cast<double>(-2 * spectrum(x)), 3e-15) << name << ", x = " << wanted_x[i];
      sum += 4 * spectrum(x) * spectrum(x);
    }
    EXPECT_NEAR(energy, static_cast<double>(sum), 1e-13 * static_cast<double>(sum)) << name;
  });
}

TEST(PulseKernel, AnIdealImpulseLeavesAmplitudesAsTheyAre) {
  const AlignedArray<double> omega = aligned_zeros<double>(kModePadding),
                             amplitudes = aligned_zeros<double>(kModePadding);
  for (std::size_t i = 0; i < kModePadding; ++i) omega[i] = 0.4 * static_cast<double>(i), amplitudes[i] = 1;
  static_cast<void>(shape_by_pulse(omega.get(), kModePadding, 0, amplitudes.get()));
  for (std::size_t i = 0; i < kModePadding; ++i) EXPECT_NEAR(amplitudes[i], 1, 1e-15);
}

}  // namespace
}  // namespace ringdown::synth
