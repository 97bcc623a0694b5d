// Modes as the kernels want them, and what they should sound like, in long double.
#pragma once

#include "engine/synth/kernels/moments.h"

#include <hwy/aligned_allocator.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

namespace ringdown::synth::test {

using Exact = std::complex<long double>;

struct Mode {
  double frequency_hz, t60_s;
  std::complex<double> start;
};

inline Exact exponent(const Mode& mode, double rate) {
  const long double d = std::log(1000.0L) / static_cast<long double>(mode.t60_s);
  const long double omega = 2 * std::numbers::pi_v<long double> * static_cast<long double>(mode.frequency_hz);
  return Exact(-d, omega) / static_cast<long double>(rate);
}

// z exp(s n), the state after n frames.
inline Exact exact_state(const Mode& mode, double rate, std::size_t n) {
  const Exact s = exponent(mode, rate);
  const auto frames = static_cast<long double>(n);
  return Exact(mode.start) * std::polar(std::exp(s.real() * frames), s.imag() * frames);
}

inline std::vector<Mode> random_modes(std::size_t count, double rate, double shortest_s = 0.005) {
  std::mt19937 random(7);
  const auto uniform = [&random] { return static_cast<double>(random()) / 4294967296.0; };
  std::vector<Mode> modes(count);
  for (Mode& mode : modes) {
    mode = {20 * std::pow(0.4999 * rate / 20, uniform()),
            shortest_s * std::pow(600 / shortest_s, uniform()),
            {uniform() - 0.5, uniform() - 0.5}};
  }
  return modes;
}

enum class Kernel { direct, moments };

class Bundle {
 public:
  // The modes come in the order of their bands.
  Bundle(std::vector<Mode> modes, double rate, Kernel kernel)
      : kernel_(kernel),
        padded_((modes.size() + kModePadding - 1) / kModePadding * kModePadding),
        rows_(zeros<double>(kRows * padded_)),
        strides_(zeros<float>(2 * padded_)),
        runs_(zeros<float>(padded_ * 2 * kRun)),
        weights_(zeros<float>(padded_ * 2 * kMoments)),
        band_(padded_, 0),
        groups_(padded_ / kModePadding) {
    std::ranges::sort(modes, {}, &Mode::frequency_hz);
    std::iota(groups_.begin(), groups_.end(), 0);
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const std::complex<double> s(exponent(modes[i], rate)), pole = std::exp(s);
      const std::complex<double> stride = std::exp(s * static_cast<double>(kRun));
      const std::complex<double> full = std::exp(s * static_cast<double>(kChunkFrames));
      const double values[kRows] = {modes[i].start.real(), modes[i].start.imag(), pole.real(),
                                    pole.imag(),           full.real(),           full.imag()};
      for (std::size_t row = 0; row < kRows; ++row) rows_[row * padded_ + i] = values[row];
      strides_[i] = static_cast<float>(stride.real());
      strides_[padded_ + i] = static_cast<float>(stride.imag());
      std::ranges::copy(run_of(s), &runs_[i * 2 * kRun]);
      if (kernel == Kernel::direct) continue;
      std::fill(band_.begin() + static_cast<std::ptrdiff_t>(i), band_.end(), band_of(s));  // the padding's: the last
      std::ranges::copy(moment_weights(s), &weights_[i * 2 * kMoments]);
    }
    active_ = {groups_.data(), groups_.size()};
  }

  // `frames` samples in chunks of the given sizes, over and over, added to zeros.
  std::vector<double> render(std::size_t frames, const std::vector<std::size_t>& chunks) {
    std::vector<double> out(frames, 0.0);
    for (std::size_t done = 0, i = 0; done < frames; ++i) {
      const std::size_t size = std::min(chunks[i % chunks.size()], frames - done);
      add(out.data() + done, size);
      done += size;
    }
    return out;
  }
  void add(double* out, std::size_t frames) {
    if (kernel_ == Kernel::direct) {
      sane = render_modes(arrays(frames), active_, limits, out, frames);
      return;
    }
    gather(frames);
    last_other.assign(frames, 0.0);
    synthesis_->add(*left_, *right_, out, last_other.data(), frames);
  }
  // Moves on, and leaves the moments to be looked at.
  const MomentSums& gather(std::size_t frames) {
    left_->of.fill(0);
    right_->of.fill(0);
    const MomentTarget targets[] = {{left_.get(), 1.0f}, {right_.get(), -0.5f}};
    sane = add_moments(arrays(frames), {band_.data(), weights_.get()}, active_, frames, limits, targets);
    return *left_;
  }
  void skip(std::size_t frames, std::size_t chunk) {
    double ignored[kChunkFrames];
    for (std::size_t done = 0; done < frames; done += chunk) add(ignored, std::min(chunk, frames - done));
  }
  [[nodiscard]] std::complex<double> state(std::size_t i) const { return {rows_[i], rows_[padded_ + i]}; }
  [[nodiscard]] double energy() const {  // the sum of |z|^2
    double sum = 0;
    for (std::size_t i = 0; i < padded_; ++i) sum += std::norm(state(i));
    return sum;
  }
  [[nodiscard]] std::size_t active_groups() const { return active_.count; }

  EnergyLimits limits{-1, 1e24};
  bool sane = true;                // what the last call returned
  std::vector<double> last_other;  // the second output of the last call, -0.5 times the first

 private:
  static constexpr std::size_t kRows = 6;

  template <class T>
  static hwy::AlignedFreeUniquePtr<T[]> zeros(std::size_t count) {
    auto block = hwy::AllocateAligned<T>(count);
    std::fill_n(block.get(), count, T{0});
    return block;
  }
  [[nodiscard]] ModeArrays arrays(std::size_t frames) {
    double* r = rows_.get();
    const bool full = frames == kChunkFrames;
    return {.z_re = r,
            .z_im = r + padded_,
            .pole_re = r + 2 * padded_,
            .pole_im = r + 3 * padded_,
            .advance_re = full ? r + 4 * padded_ : nullptr,
            .advance_im = full ? r + 5 * padded_ : nullptr,
            .stride_re = strides_.get(),
            .stride_im = strides_.get() + padded_,
            .runs = runs_.get()};
  }

  Kernel kernel_;
  std::size_t padded_;
  hwy::AlignedFreeUniquePtr<double[]> rows_;
  hwy::AlignedFreeUniquePtr<float[]> strides_, runs_, weights_;
  std::vector<std::uint16_t> band_;
  std::vector<std::uint32_t> groups_;
  ActiveGroups active_;
  std::unique_ptr<MomentSums> left_ = std::make_unique<MomentSums>(), right_ = std::make_unique<MomentSums>();
  std::unique_ptr<MomentSynthesis> synthesis_ = std::make_unique<MomentSynthesis>();
};

}  // namespace ringdown::synth::test
