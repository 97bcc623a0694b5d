// Both kernels against exp and sin in long double, and every instruction set against every other.
#include "tests/synth/mode_bundle.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <bit>
#include <cstdio>
#include <limits>
#include <string>

namespace ringdown::synth {
namespace {

using test::Bundle;
using test::Exact;
using test::exact_state;
using test::exponent;
using test::Kernel;
using test::Mode;
using test::random_modes;

double db(long double ratio) { return static_cast<double>(20 * std::log10(ratio)); }

// Largest |error| over the envelope of the mode at that time, in dB.
double worst_error_db(const Mode& mode, double rate, Kernel kernel, const std::vector<std::size_t>& chunks) {
  constexpr std::size_t kFrames = 2048;
  const auto samples = Bundle({mode}, rate, kernel).render(kFrames, chunks);
  long double worst = 0;
  for (std::size_t n = 0; n < kFrames; ++n) {
    const Exact exact = exact_state(mode, rate, n);
    if (std::abs(exact) < 1e-30L) break;
    worst = std::max(worst, std::abs(static_cast<long double>(samples[n]) - exact.real()) / std::abs(exact));
  }
  return db(worst);
}

class BothKernels : public testing::TestWithParam<Kernel> {};
INSTANTIATE_TEST_SUITE_P(All, BothKernels, testing::Values(Kernel::direct, Kernel::moments), [](const auto& kernel) {
  return kernel.param == Kernel::direct ? std::string("Direct") : std::string("Moments");
});

TEST_P(BothKernels, AKernelFollowsTheClosedFormAtEveryPitchDecayRateAndChunkSize) {
  const bool direct = GetParam() == Kernel::direct;
  double worst = -400;
  int measured = 0;
  for (const double rate : {44100.0, 48000.0, 96000.0, 192000.0}) {
    for (const double frequency : {20.0, 55.5, 440.0, 3000.0, 0.25 * rate, 0.4 * rate, 0.499 * rate}) {
      for (const double t60 : {0.005, 0.03, 0.5, 600.0}) {
        const Mode mode{frequency, t60, {0.6, -0.8}};
        if (!direct && !takes_moments(std::complex<double>(exponent(mode, rate)))) continue;
        for (const auto& chunks : std::vector<std::vector<std::size_t>>{{128}, {64}, {1}, {127, 2, 17, 33}}) {
          const double error = worst_error_db(mode, rate, GetParam(), chunks);
          worst = std::max(worst, error);
          ++measured;
          EXPECT_LT(error, direct ? -120 : -110)
              << frequency << " Hz, T60 " << t60 << " s, " << rate << " Hz, chunk " << chunks[0];
        }
      }
    }
  }
  EXPECT_GE(measured, direct ? 448 : 224);
  std::printf("against the closed form: worst error %.1f dB of the mode's envelope\n", worst);
}

TEST_P(BothKernels, AKernelKeepsStatesExactForTenMinutes) {
  const double rate = 48000;
  const auto frames = static_cast<std::size_t>(600 * rate);
  std::vector<Mode> modes;
  for (const double frequency : {20.0, 100.0, 440.0, 1000.0, 5000.0, 12000.0, 20000.0, 23952.0}) {
    modes.push_back({frequency, 600, {0, -1}});
  }
  for (const std::size_t chunk : {std::size_t{128}, std::size_t{37}}) {
    Bundle bundle(modes, rate, GetParam());
    bundle.skip(frames, chunk);
    double worst = -400;
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const Exact exact = exact_state(modes[i], rate, frames);
      const double error = db(std::abs(Exact(bundle.state(i)) - exact) / std::abs(exact));
      worst = std::max(worst, error);
      EXPECT_LT(error, -140) << modes[i].frequency_hz << " Hz, chunk " << chunk;
    }
    std::printf("state after ten minutes in chunks of %zu: worst error %.1f dB\n", chunk, worst);
  }
}

TEST_P(BothKernels, AKernelsOutputIsTheSumOverModesWhateverTheirNumber) {
  const double rate = 48000;
  for (const std::size_t count : {1, 7, 8, 9, 31, 32, 33, 100, 2000}) {
    const auto modes = random_modes(count, rate, 0.025);
    const auto together = Bundle(modes, rate, GetParam()).render(300, {128});
    long double power = 0, wrong = 0;
    for (std::size_t n = 0; n < together.size(); ++n) {
      long double sum = 0;
      for (const Mode& mode : modes) sum += exact_state(mode, rate, n).real();
      power += sum * sum;
      wrong += std::pow(static_cast<long double>(together[n]) - sum, 2);
    }
    EXPECT_LT(db(std::sqrt(wrong / power)), -115) << count << " modes";
  }
}

TEST_P(BothKernels, AKernelAddsToWhatIsInTheOutput) {
  const Mode mode{440, 1, {0, -1}};
  const auto plain = Bundle({mode}, 48000, GetParam()).render(64, {64});
  std::vector<double> out(64, 0.25);
  Bundle({mode}, 48000, GetParam()).add(out.data(), 64);
  for (std::size_t n = 0; n < 64; ++n) EXPECT_NEAR(out[n], plain[n] + 0.25, 1e-15);
}

TEST(Moments, MomentsGiveEachTargetItsShare) {
  Bundle bundle(random_modes(50, 48000, 0.1), 48000, Kernel::moments);
  std::vector<double> out(128, 0.0);
  bundle.add(out.data(), 128);
  const double loudest = std::abs(*std::ranges::max_element(out, {}, [](double x) { return std::abs(x); }));
  for (std::size_t n = 0; n < 128; ++n) EXPECT_NEAR(bundle.last_other[n], -0.5 * out[n], 1e-6 * loudest);
}

TEST(Moments, MomentsAreNotForModesThatDecayFastOrLieAboveNyquist) {
  const auto takes = [](double hz, double t60) {
    return takes_moments(std::complex<double>(exponent({hz, t60, {}}, 48000)));
  };
  EXPECT_TRUE(takes(20, 600));
  EXPECT_TRUE(takes(23952, 0.03));
  EXPECT_FALSE(takes(1000, 0.02));
  EXPECT_FALSE(takes(24000, 1));
  EXPECT_FALSE(takes_moments({1e-9, 0.1}));  // it would grow
}

TEST_P(BothKernels, AKernelLeavesOutGroupsThatHaveDied) {
  std::vector<Mode> modes;
  for (int i = 0; i < 24; ++i) modes.push_back({200.0 + 400 * i, i < 8 ? 10.0 : 0.05, {0, -1}});
  Bundle bundle(modes, 48000, GetParam());
  bundle.limits.floor = 1e-12;
  bundle.render(48, {48});
  EXPECT_EQ(bundle.active_groups(), 3u);
  bundle.render(9600, {128});
  EXPECT_EQ(bundle.active_groups(), 1u);
  bundle.limits.floor = 1e6;
  bundle.render(128, {128});
  EXPECT_EQ(bundle.active_groups(), 0u);
  EXPECT_EQ(bundle.render(128, {128}), std::vector<double>(128, 0.0));
}

// Whatever else rings, a state that is not a number must show in the returned value: the voice relies on it.
TEST_P(BothKernels, AKernelReportsAStateThatIsNotFiniteInAnyLane) {
  for (const double poison : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (const std::size_t count : {1, 5, 8, 16, 40}) {
      for (std::size_t bad = 0; bad < count; ++bad) {
        auto modes = random_modes(count, 48000, 0.05);
        modes[bad].start = {0, poison};
        Bundle bundle(modes, 48000, GetParam());
        const auto out = bundle.render(64, {64});
        EXPECT_FALSE(bundle.sane) << "mode " << bad << " of " << count;
        if (GetParam() == Kernel::direct) continue;
        for (const double sample : out) ASSERT_TRUE(std::isfinite(sample)) << "mode " << bad << " of " << count;
      }
    }
  }
}

TEST_P(BothKernels, AKernelGivesTheSameOnEveryInstructionSet) {
  const auto modes = random_modes(77, 48000, 0.03);
  std::vector<std::pair<std::string, std::vector<double>>> runs;
  const std::int64_t supported = hwy::SupportedTargets();
  for (std::int64_t rest = supported; rest != 0; rest &= rest - 1) {
    hwy::SetSupportedTargetsForTest(rest & -rest);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    runs.emplace_back(kernel_target(), Bundle(modes, 48000, GetParam()).render(4096, {64, 13, 128}));
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  ASSERT_GE(runs.size(), 1u);
  std::printf("instruction sets compared:");
  for (const auto& [target, samples] : runs) {
    std::printf(" %s", target.c_str());
    for (std::size_t n = 0; n < samples.size(); ++n) ASSERT_NEAR(samples[n], runs[0].second[n], 2e-5) << target;
  }
  std::printf("\n");
}

// States turn denormal long before they reach zero; a flushed one must reach it.
TEST_P(BothKernels, ADyingTailNeverGetsIntoDenormals) {
  const DenormalGuard guard;
  Bundle bundle({{440, 0.03, {0, -1}}, {20, 0.03, {1, 0}}, {20000, 0.03, {1e-300, 0}}}, 48000, GetParam());
  for (int chunk = 0; chunk < 9000; ++chunk) {
    bundle.render(64, {64});
    for (std::size_t i = 0; i < 3; ++i) {
      for (const double part : {bundle.state(i).real(), bundle.state(i).imag()}) {
        // fpclassify() would itself be fooled by the guard: look at the bits.
        ASSERT_TRUE((std::bit_cast<std::uint64_t>(part) << 1) == 0 ||
                    (std::bit_cast<std::uint64_t>(part) >> 52 & 0x7ff) != 0)
            << "chunk " << chunk;
      }
    }
  }
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(bundle.state(i), std::complex<double>(0, 0));
}

}  // namespace
}  // namespace ringdown::synth
