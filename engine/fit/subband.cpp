#include "engine/fit/subband.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

// Filtering, shifting to 0 Hz and thinning out take one pass over all bands. A sample of a band is the product of the
// filter, shifted to the centre frequency, with one stretch of the signal, rotated back by the phase of that frequency
// at the stretch's beginning. The centres are a whole number of steps of 1 / `period` apart, so that the shifts of two
// bands differ by a factor that repeats after `period` samples. Therefore each stretch is multiplied by the first
// band's filter and folded to one period, and the bands are a discrete Fourier transform of that.
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

Eigen::MatrixXcd SubbandFilter::take(std::span<const double> signal, double centre, std::size_t bands) const {
  const auto rows = static_cast<Eigen::Index>(bands), length = static_cast<Eigen::Index>(taps_.size());
  if (signal.size() < taps_.size()) return Eigen::MatrixXcd(rows, 0);
  static_assert(kCore == 0.5);
  const std::size_t period = 2 * step_;
  const auto turned = [](double turns) { return std::polar(1.0, -2 * std::numbers::pi * std::fmod(turns, 1.0)); };
  Eigen::VectorXcd filter(length);
  for (Eigen::Index k = 0; k < length; ++k)
    filter[k] = taps_[static_cast<std::size_t>(k)] * turned(centre * static_cast<double>(k));
  const auto count = static_cast<Eigen::Index>((signal.size() - taps_.size()) / step_ + 1);
  Eigen::MatrixXcd folded = Eigen::MatrixXcd::Zero(static_cast<Eigen::Index>(period), count);
  for (Eigen::Index m = 0; m < count; ++m) {
    const double* const part = signal.data() + static_cast<std::size_t>(m) * step_;
    for (Eigen::Index first = 0; first < length; first += folded.rows()) {
      const Eigen::Index size = std::min(folded.rows(), length - first);
      folded.col(m).head(size) +=
          filter.segment(first, size).cwiseProduct(Eigen::Map<const Eigen::VectorXd>(part + first, size));
    }
  }
  constexpr Eigen::Index kRows = 64;  // of the transform at once
  Eigen::MatrixXcd samples(rows, count);
  for (Eigen::Index above = 0; above < rows; above += kRows) {
    Eigen::MatrixXcd transform(std::min(kRows, rows - above), folded.rows());
    for (Eigen::Index r = 0; r < transform.cols(); ++r) {
      for (Eigen::Index b = 0; b < transform.rows(); ++b)
        transform(b, r) = turned(static_cast<double>((above + b) * r) / static_cast<double>(period));
    }
    samples.middleRows(above, transform.rows()).noalias() = transform * folded;
  }
  for (Eigen::Index m = 0; m < count; ++m) {
    const double first = static_cast<double>(static_cast<std::size_t>(m) * step_);
    for (Eigen::Index b = 0; b < rows; ++b)
      samples(b, m) *= turned((centre + static_cast<double>(b) / static_cast<double>(period)) * first);
  }
  return samples;
}

}  // namespace ringdown::fit
