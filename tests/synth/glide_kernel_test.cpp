// The kernels for a changed pitch take eight modes at once; the tests compute each mode by itself.
#include "engine/synth/kernels/glide_kernel.h"
#include "tests/synth/every_instruction_set.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <random>
#include <vector>

namespace ringdown::synth {
namespace {

using Complex = std::complex<long double>;

TEST(GlideKernel, PhasesTurnByTheAnglesOnEveryInstructionSet) {
  alignas(64) const std::array<double, kModePadding> angles = {0, 1e-9, 1e-4, -2e-3, 0.1, -0.7, 2, 3};
  test::on_every_instruction_set([&](const char* name) {
    Turns turns;
    find_turns(angles.data(), turns);
    struct Case {
      const Turns::Row& row;
      std::size_t frames;
    };
    for (const Case& one : {Case{turns.frame, 1}, Case{turns.run, kRun}, Case{turns.chunk, kChunkFrames}}) {
      for (std::size_t i = 0; i < kModePadding; ++i) {
        const Complex exact =
            std::polar(1.0L, static_cast<long double>(angles[i]) * static_cast<long double>(one.frames));
        const double allowed = 1e-15 * static_cast<double>(one.frames);
        EXPECT_NEAR(one.row.re[i], static_cast<double>(exact.real()), allowed) << name << ", " << angles[i];
        EXPECT_NEAR(one.row.im[i], static_cast<double>(exact.imag()), allowed) << name << ", " << angles[i];
      }
    }
  });
}

// A mode's weights make its samples from the shapes q_p, whichever of two neighbouring bands it is seen from.
TEST(GlideKernel, WeightsGiveTheClosedFormOnEveryInstructionSet) {
  test::on_every_instruction_set([&](const char* name) {
    MovedWeights weights = {};
    for (std::size_t i = 0; i < kModePadding; ++i) {
      weights.decay[i] = -1e-4 * static_cast<double>(i);
      weights.omega[i] = 0.3 * static_cast<double>(i) + 0.01;
      weights.band[i] = std::round(weights.omega[i] / kPerBand);
    }
    find_weights(weights);
    for (std::size_t i = 0; i < kModePadding; ++i) {
      for (const std::size_t frame : {std::size_t{0}, std::size_t{1}, std::size_t{60}, kChunkFrames - 1}) {
        const auto j = static_cast<double>(frame);
        const auto shapes = moment_shapes((j - kMomentMiddle) / kMomentScale);
        std::complex<double> sum;
        for (std::size_t p = 0; p < kMoments; ++p) {
          sum += shapes[p] * std::complex<double>(weights.of[p][i], weights.of[kMoments + p][i]);
        }
        sum *= std::polar(1.0, kPerBand * weights.band[i] * j);
        const auto exact = std::exp(std::complex<double>(weights.decay[i], weights.omega[i]) * j);
        EXPECT_NEAR(std::abs(sum - exact), 0, 2e-6) << name << ", mode " << i << ", frame " << frame;
      }
    }
  });
}

TEST(GlideKernel, SharesAddUpOnEveryInstructionSet) {
  std::mt19937 random(1);
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{99}}) {
    std::vector<std::int8_t> shares(count * kModePadding);
    std::vector<float> amounts(count);
    for (std::int8_t& share : shares) share = static_cast<std::int8_t>(static_cast<int>(random() % 255) - 127);
    for (float& amount : amounts) amount = static_cast<float>(random() % 1000);
    std::array<double, kModePadding> exact{};
    for (std::size_t l = 0; l < count; ++l) {
      for (std::size_t i = 0; i < kModePadding; ++i) {
        exact[i] += static_cast<double>(shares[l * kModePadding + i]) * static_cast<double>(amounts[l]);
      }
    }
    test::on_every_instruction_set([&](const char* name) {
      std::array<float, kModePadding> out;
      add_shares(shares.data(), amounts.data(), count, out.data());
      for (std::size_t i = 0; i < kModePadding; ++i) {
        EXPECT_NEAR(static_cast<double>(out[i]), exact[i], 1.0 + 1e-6 * std::abs(exact[i])) << name;
      }
    });
  }
}

}  // namespace
}  // namespace ringdown::synth
