// The kernel against exp and sin in long double, and every instruction set against every other.
#include "engine/synth/mode_kernel.h"

#include <gtest/gtest.h>
#include <hwy/aligned_allocator.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <bit>
#include <complex>
#include <cstdio>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace ringdown::synth {
namespace {

using Exact = std::complex<long double>;

struct Mode {
  double frequency_hz, t60_s;
  std::complex<double> start;
};

Exact exponent(const Mode& mode, double rate) {
  const long double d = std::log(1000.0L) / static_cast<long double>(mode.t60_s);
  const long double omega = 2 * std::numbers::pi_v<long double> * static_cast<long double>(mode.frequency_hz);
  return Exact(-d, omega) / static_cast<long double>(rate);
}

// z exp(s n), the state after n frames.
Exact exact_state(const Mode& mode, double rate, std::size_t n) {
  const Exact s = exponent(mode, rate);
  const auto frames = static_cast<long double>(n);
  return Exact(mode.start) * std::polar(std::exp(s.real() * frames), s.imag() * frames);
}

// The arrays that the kernel works on.
class Bundle {
 public:
  Bundle(const std::vector<Mode>& modes, double rate)
      : padded_((modes.size() + kModePadding - 1) / kModePadding * kModePadding),
        rows_(hwy::AllocateAligned<double>(6 * padded_)) {
    std::fill_n(rows_.get(), 6 * padded_, 0.0);
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const std::complex<double> pole(std::exp(exponent(modes[i], rate)));
      const std::complex<double> chunk(std::exp(static_cast<long double>(kChunkFrames) * exponent(modes[i], rate)));
      const double values[] = {modes[i].start.real(), modes[i].start.imag(), pole.real(),
                               pole.imag(),           chunk.real(),          chunk.imag()};
      for (std::size_t row = 0; row < 6; ++row) rows_[row * padded_ + i] = values[row];
    }
  }

  // `frames` samples in chunks of the given sizes, over and over.
  std::vector<double> render(std::size_t frames, const std::vector<std::size_t>& chunks) {
    std::vector<double> out(frames, 0.0);
    for (std::size_t done = 0, i = 0; done < frames; ++i) {
      const std::size_t size = std::min(chunks[i % chunks.size()], frames - done);
      last_return = render_modes(arrays(), out.data() + done, size);
      done += size;
    }
    return out;
  }
  void skip(std::size_t frames, std::size_t chunk) {
    double ignored[kChunkFrames];
    for (std::size_t done = 0; done < frames; done += chunk) {
      render_modes(arrays(), ignored, std::min(chunk, frames - done));
    }
  }
  [[nodiscard]] std::complex<double> state(std::size_t i) const { return {rows_[i], rows_[padded_ + i]}; }
  [[nodiscard]] ModeArrays arrays() {
    double* r = rows_.get();
    return {r, r + padded_, r + 2 * padded_, r + 3 * padded_, r + 4 * padded_, r + 5 * padded_, padded_};
  }

  double last_return = 0;

 private:
  std::size_t padded_;
  hwy::AlignedFreeUniquePtr<double[]> rows_;
};

// Largest |error| over the amplitude the mode started with, in dB.
double worst_error_db(const Mode& mode, double rate, const std::vector<std::size_t>& chunks) {
  constexpr std::size_t kFrames = 4096;
  const auto samples = Bundle({mode}, rate).render(kFrames, chunks);
  long double worst = 0;
  for (std::size_t n = 0; n < kFrames; ++n) {
    worst = std::max(worst, std::abs(static_cast<long double>(samples[n]) - exact_state(mode, rate, n).real()));
  }
  return static_cast<double>(20 * std::log10(worst / std::abs(Exact(mode.start))));
}

std::vector<Mode> random_modes(std::size_t count, double rate) {
  std::mt19937 random(7);
  const auto uniform = [&random] { return static_cast<double>(random()) / 4294967296.0; };
  std::vector<Mode> modes(count);
  for (Mode& mode : modes) {
    mode = {20 * std::pow(0.4999 * rate / 20, uniform()),
            0.005 * std::pow(120000.0, uniform()),
            {uniform() - 0.5, uniform() - 0.5}};
  }
  return modes;
}

TEST(ModeKernel, FollowsTheClosedFormAtEveryPitchDecayRateAndChunkSize) {
  double worst = -400;
  for (const double rate : {44100.0, 48000.0, 96000.0, 192000.0}) {
    for (const double frequency : {20.0, 55.5, 440.0, 3000.0, 0.25 * rate, 0.4 * rate, 0.499 * rate}) {
      for (const double t60 : {0.005, 0.5, 600.0}) {
        for (const auto& chunks : std::vector<std::vector<std::size_t>>{{64}, {1}, {63, 2, 17}}) {
          for (const std::complex<double> start : {std::complex(0.0, -1.0), std::complex(0.6, 0.8)}) {
            const double error = worst_error_db({frequency, t60, start}, rate, chunks);
            worst = std::max(worst, error);
            EXPECT_LT(error, -200) << frequency << " Hz, T60 " << t60 << " s, " << rate << " Hz, chunk " << chunks[0];
          }
        }
      }
    }
  }
  std::printf("kernel against the closed form: worst error %.1f dB of the mode's amplitude\n", worst);
}

TEST(ModeKernel, KeepsItsStateExactForTenMinutes) {
  const double rate = 48000;
  const auto frames = static_cast<std::size_t>(600 * rate);
  std::vector<Mode> modes;
  for (const double frequency : {20.0, 100.0, 440.0, 1000.0, 5000.0, 12000.0, 20000.0, 23952.0}) {
    modes.push_back({frequency, 600, {0, -1}});
  }
  for (const std::size_t chunk : {std::size_t{64}, std::size_t{37}}) {
    Bundle bundle(modes, rate);
    bundle.skip(frames, chunk);
    double worst = -400;
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const Exact exact = exact_state(modes[i], rate, frames);
      const double error =
          static_cast<double>(20 * std::log10(std::abs(Exact(bundle.state(i)) - exact) / std::abs(exact)));
      worst = std::max(worst, error);
      EXPECT_LT(error, -140) << modes[i].frequency_hz << " Hz, chunk " << chunk;
    }
    std::printf("state after ten minutes in chunks of %zu: worst error %.1f dB\n", chunk, worst);
  }
}

TEST(ModeKernel, IsASumOverModesWhateverTheirNumber) {
  const double rate = 48000;
  for (const std::size_t count : {1, 7, 8, 9, 31, 32, 33, 100}) {
    const auto modes = random_modes(count, rate);
    const auto together = Bundle(modes, rate).render(500, {64});
    std::vector<long double> sum(500, 0);
    for (const Mode& mode : modes) {
      for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += exact_state(mode, rate, n).real();
    }
    for (std::size_t n = 0; n < sum.size(); ++n) {
      ASSERT_NEAR(together[n], static_cast<double>(sum[n]), 1e-10 * static_cast<double>(count)) << count << ", " << n;
    }
  }
}

TEST(ModeKernel, AddsToWhatIsThere) {
  const Mode mode{440, 1, {0, -1}};
  const auto plain = Bundle({mode}, 48000).render(64, {64});
  std::vector<double> out(64, 0.25);
  Bundle bundle({mode}, 48000);
  render_modes(bundle.arrays(), out.data(), 64);
  for (std::size_t n = 0; n < 64; ++n) EXPECT_NEAR(out[n], plain[n] + 0.25, 1e-15);
}

// Whatever else rings, a state that is not a number must show in the returned value: the voice relies on it.
TEST(ModeKernel, ReportsAStateThatIsNotFiniteInAnyLane) {
  for (const double poison : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (const std::size_t count : {1, 5, 8, 16, 40}) {
      for (std::size_t bad = 0; bad < count; ++bad) {
        auto modes = random_modes(count, 48000);
        modes[bad].start = {0, poison};
        Bundle bundle(modes, 48000);
        bundle.render(64, {64});
        EXPECT_FALSE(std::isfinite(bundle.last_return)) << "mode " << bad << " of " << count;
      }
    }
  }
}

TEST(ModeKernel, GivesTheSameOnEveryInstructionSet) {
  const auto modes = random_modes(77, 48000);
  std::vector<std::pair<std::string, std::vector<double>>> runs;
  const std::int64_t supported = hwy::SupportedTargets();
  for (std::int64_t rest = supported; rest != 0; rest &= rest - 1) {
    hwy::SetSupportedTargetsForTest(rest & -rest);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    runs.emplace_back(kernel_target(), Bundle(modes, 48000).render(4096, {64, 13}));
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  ASSERT_GE(runs.size(), 1u);
  std::printf("instruction sets compared:");
  for (const auto& [target, samples] : runs) {
    std::printf(" %s", target.c_str());
    for (std::size_t n = 0; n < samples.size(); ++n) ASSERT_NEAR(samples[n], runs[0].second[n], 1e-10) << target;
  }
  std::printf("\n");
}

// Two-pole filters turn denormal long before they reach zero; a flushed one must reach it.
TEST(ModeKernel, ADyingTailNeverGetsIntoDenormals) {
  const DenormalGuard guard;
  Bundle bundle({{440, 0.005, {0, -1}}, {20, 0.02, {1, 0}}, {20000, 0.005, {1e-300, 0}}}, 48000);
  for (int chunk = 0; chunk < 2000; ++chunk) {
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
  EXPECT_EQ(bundle.last_return, 0);
}

}  // namespace
}  // namespace ringdown::synth
