#include "engine/fit/subband.h"

#include <cmath>
#include <complex>
#include <numbers>

// Filtering, shifting to 0 Hz and thinning out take one pass. Each sample of the band is the product of the filter,
// shifted to the centre frequency, with one stretch of the signal, rotated back by the phase of that frequency at the
// stretch's beginning. Only every `step`-th sample is computed, so a band costs (signal / step) x taps products.
namespace ringdown::fit {
namespace {

constexpr double kAttenuation_db = 100;

}  // namespace

// Kaiser's window, its formulas for length and beta: Oppenheim & Schafer, Discrete-Time Signal Processing, section 7.6.
SubbandFilter::SubbandFilter(std::size_t step) : step_(step) {
  const double pass = 0.52 * kCore, stop = kStop;  // shares of the output's rate
  const double width = 2 * std::numbers::pi * (stop - pass) / static_cast<double>(step);
  const double cutoff = std::numbers::pi * (stop + pass) / static_cast<double>(step);
  const auto half = static_cast<long>(std::ceil((kAttenuation_db - 8) / (2.285 * width) / 2));
  const double beta = 0.1102 * (kAttenuation_db - 8.7);
  const double scale = 1 / std::cyl_bessel_i(0.0, beta);
  for (long k = -half; k <= half; ++k) {
    const double x = static_cast<double>(k) / static_cast<double>(half);
    const double sinc = k == 0 ? cutoff : std::sin(cutoff * static_cast<double>(k)) / static_cast<double>(k);
    const double window = scale * std::cyl_bessel_i(0.0, beta * std::sqrt(1 - x * x));
    taps_.push_back(window * sinc / std::numbers::pi);
  }
}

Eigen::VectorXcd SubbandFilter::take(std::span<const double> signal, double centre) const {
  if (signal.size() < taps_.size()) return {};
  const double turn = -2 * std::numbers::pi * centre;
  const auto length = static_cast<Eigen::Index>(taps_.size());
  Eigen::VectorXd real(length), imaginary(length);
  for (Eigen::Index k = 0; k < length; ++k) {
    const std::complex<double> tap = std::polar(taps_[static_cast<std::size_t>(k)], turn * static_cast<double>(k));
    real[k] = tap.real();
    imaginary[k] = tap.imag();
  }
  Eigen::VectorXcd band(static_cast<Eigen::Index>((signal.size() - taps_.size()) / step_ + 1));
  for (Eigen::Index m = 0; m < band.size(); ++m) {
    const std::size_t first = static_cast<std::size_t>(m) * step_;
    const Eigen::Map<const Eigen::VectorXd> part(signal.data() + first, length);
    const double turns = std::fmod(centre * static_cast<double>(first), 1.0);
    band[m] = std::complex(real.dot(part), imaginary.dot(part)) * std::polar(1.0, -2 * std::numbers::pi * turns);
  }
  return band;
}

}  // namespace ringdown::fit
