// Where a sound's power lies as time goes on.
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

namespace ringdown::synth::test {

// The centre of a sound's power spectrum in each 50 ms [Hz].
inline std::vector<double> centroids(const std::vector<double>& sound) {
  constexpr double kSampleRate_hz = 48000;
  constexpr std::size_t kWindow = 2400;
  std::vector<double> hann(kWindow), part(kWindow), centres;
  for (std::size_t n = 0; n < kWindow; ++n)
    hann[n] = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * static_cast<double>(n) / kWindow);
  for (std::size_t begin = 0; begin + kWindow <= sound.size(); begin += kWindow) {
    double weighed = 0, power = 0;
    for (std::size_t n = 0; n < kWindow; ++n) part[n] = hann[n] * sound[begin + n];
    for (std::size_t bin = 1; bin < kWindow / 2; ++bin) {
      std::complex<double> sum, at = 1;
      const std::complex<double> turn = std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(bin) / kWindow);
      for (std::size_t n = 0; n < kWindow; ++n, at *= turn) sum += part[n] * at;
      power += std::norm(sum);
      weighed += std::norm(sum) * static_cast<double>(bin) * kSampleRate_hz / kWindow;
    }
    centres.push_back(weighed / power);
  }
  return centres;
}

}  // namespace ringdown::synth::test
