// A narrow band of a real signal as a slow complex one.
//
// The band around a centre frequency is moved to 0 Hz, filtered, and thinned out to every `step`-th sample. Only places
// where the whole filter lies inside the signal are kept, so that an exponential comes out as an exponential: its pole
// is exact, whatever the filter does to its amplitude. [any]
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::fit {

class SubbandFilter {
 public:
  // Bands of `step` samples to one.
  explicit SubbandFilter(std::size_t step);

  // How much of the band, of the sample rate of what comes out, is flat and free of aliases: what lies within
  // +-kCore / 2 of the centre. What lies outside of +-kStop is 100 dB down; between, it appears outside of the core.
  static constexpr double kCore = 0.5, kStop = 0.73;

  [[nodiscard]] std::size_t step() const { return step_; }
  [[nodiscard]] std::size_t taps() const { return taps_.size(); }

  // Every step-th sample of the band, the first at the signal's own first. Empty when the signal is shorter than the
  // filter. `centre` in cycles per sample.
  [[nodiscard]] Eigen::VectorXcd take(std::span<const double> signal, double centre) const;

 private:
  std::size_t step_;
  std::vector<double> taps_;
};

}  // namespace ringdown::fit
