// Converts a narrow band of a real signal to a slow complex signal. [any]
//
// The band around a centre frequency is moved to 0 Hz, filtered, and thinned out to every `step`-th sample. Only
// positions where the whole filter lies inside the signal are kept, so an exponential remains an exponential: its pole
// is exact, whatever the filter does to its amplitude.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::fit {

class SubbandFilter {
 public:
  // Makes bands that have one sample for every `step` samples of the signal.
  explicit SubbandFilter(std::size_t step);

  // Shares of the output's sample rate. Frequencies within +-kCore / 2 of the centre are flat and free of aliases.
  // Those outside +-kStop are 100 dB down. Frequencies in between appear outside the core.
  static constexpr double kCore = 0.5, kStop = 0.73;

  [[nodiscard]] std::size_t step() const { return step_; }
  [[nodiscard]] std::size_t taps() const { return taps_.size(); }

  // Returns every step-th sample of `bands` neighbouring bands, beginning at the signal's first sample: one row for
  // each band. The first band's centre is `centre`, in cycles per sample, and each next one lies kCore of the output's
  // rate higher. No samples when the signal is shorter than the filter.
  [[nodiscard]] Eigen::MatrixXcd take(std::span<const double> signal, double centre, std::size_t bands) const;

 private:
  std::size_t step_;
  std::vector<double> taps_;
};

}  // namespace ringdown::fit
