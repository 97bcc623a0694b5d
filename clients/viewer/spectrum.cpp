#include "clients/viewer/spectrum.h"

#include <kiss_fftr.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

// The spectrum of the last kFrames samples: a Hann window, a real Fourier transform, and the size of each bin in dB. A
// Hann window spreads a sine over three bins, and between two bins reads it 1.4 dB too low at most; but its side lobes
// fall fast enough that loud modes do not hide quiet ones.
namespace ringdown::viewer {

struct Spectrum::Plan {
  struct Free {
    void operator()(kiss_fftr_cfg plan) const { kiss_fftr_free(plan); }
  };
  std::unique_ptr<kiss_fftr_state, Free> fft{kiss_fftr_alloc(kFrames, 0, nullptr, nullptr)};
  std::array<float, kFrames> window{}, frames{};
  std::array<kiss_fft_cpx, kFrames / 2 + 1> bins{};
  std::vector<float> levels = std::vector<float>(kFrames / 2 + 1, static_cast<float>(kFloor_db));
};

Spectrum::Spectrum() : plan_(std::make_unique<Plan>()) {
  for (std::size_t i = 0; i < kFrames; ++i) {
    plan_->window[i] = static_cast<float>(0.5 - 0.5 * std::cos(2 * std::numbers::pi * double(i) / kFrames));
  }
}
Spectrum::~Spectrum() = default;
Spectrum::Spectrum(Spectrum&&) noexcept = default;
Spectrum& Spectrum::operator=(Spectrum&&) noexcept = default;

std::span<const float> Spectrum::analyse(std::span<const float> samples) {
  Plan& plan = *plan_;
  const auto last = samples.last(std::min(samples.size(), kFrames));
  const std::size_t silent = kFrames - last.size();
  std::fill_n(plan.frames.begin(), silent, 0.0f);
  for (std::size_t i = 0; i < last.size(); ++i) plan.frames[silent + i] = last[i] * plan.window[silent + i];
  kiss_fftr(plan.fft.get(), plan.frames.data(), plan.bins.data());
  // The window's mean is 1/2, and half of a sine's amplitude lies at its negative frequency.
  constexpr double kScale = 4.0 / kFrames;
  for (std::size_t k = 0; k < plan.bins.size(); ++k) {
    const double amplitude = kScale * std::hypot(plan.bins[k].r, plan.bins[k].i);
    plan.levels[k] = static_cast<float>(std::max(kFloor_db, 20 * std::log10(amplitude + 1e-12)));
  }
  return plan.levels;
}

}  // namespace ringdown::viewer
