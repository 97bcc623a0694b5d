// The free motion of places of an object against a recurrence in long double.
#include "engine/synth/kernels/aligned_array.h"
#include "engine/synth/kernels/drive_kernel.h"
#include "tests/synth/every_instruction_set.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

namespace ringdown::synth {
namespace {

using Complex = std::complex<long double>;

constexpr std::size_t kColumns = 5 * kModePadding, kPlaces = 3, kSteps = 64;

// Modes from a fraction of a hertz to Nyquist.
struct Touched {
  AlignedArray<double> z = aligned_zeros<double>(2 * kColumns), p = aligned_zeros<double>(2 * kColumns),
                       weight = aligned_zeros<double>(kPlaces * kColumns);

  Touched() {
    std::mt19937 random(3);
    const auto uniform = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
    for (std::size_t c = 0; c < kColumns; ++c) {
      const double omega = 1e-5 * std::pow(3.1e5, static_cast<double>(c) / (kColumns - 1));
      const auto pole = std::exp(std::complex<double>(-1e-4 * static_cast<double>(c % 7), omega));
      p[c] = pole.real(), p[kColumns + c] = pole.imag();
      z[c] = uniform(), z[kColumns + c] = uniform();
      for (std::size_t k = 0; k < kPlaces; ++k) weight[k * kColumns + c] = uniform();
    }
  }
  [[nodiscard]] Complex at(const AlignedArray<double>& rows, std::size_t c) const {
    return {rows[c], rows[kColumns + c]};
  }
  [[nodiscard]] ModeArrays modes(double* states) const {
    return {.z_re = states, .z_im = states + kColumns, .pole_re = p.get(), .pole_im = p.get() + kColumns};
  }
};

TEST(TouchKernel, FreeMotionFollowsTheRecurrenceOnEveryInstructionSet) {
  const Touched touched;
  constexpr std::size_t kPoints = kSteps + 1;
  for (std::size_t places = 1; places <= 5; ++places) {
    test::on_every_instruction_set([&](const char* name) {
      alignas(64) std::array<std::array<double, kSteps + 8>, 5> room{};
      std::vector<const double*> weights;
      std::vector<double*> out;
      for (std::size_t k = 0; k < places; ++k) {
        weights.push_back(touched.weight.get() + k % kPlaces * kColumns);
        out.push_back(room[k].data());
      }
      free_motion(touched.modes(touched.z.get()), kColumns, weights, out, kPoints);
      for (std::size_t k = 0; k < places; ++k) {
        std::vector<long double> exact(kPoints);
        for (std::size_t c = 0; c < kColumns; ++c) {
          Complex z = touched.at(touched.z, c);
          for (long double& sum : exact) sum += weights[k][c] * z.real(), z *= touched.at(touched.p, c);
        }
        for (std::size_t n = 0; n < kPoints; ++n) {
          EXPECT_NEAR(room[k][n], static_cast<double>(exact[n]), 1e-11) << name << ", place " << k << ", step " << n;
        }
      }
    });
  }
}

}  // namespace
}  // namespace ringdown::synth
