// Measures what a listener would hear, from samples alone. Shares no code with the engine. [any thread]
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::test {

using Samples = std::vector<double>;

// exp(-decay t) (sine sin(2 pi f t) + cosine cos(2 pi f t)), t = 0 at the first sample.
struct DampedSinusoid {
  double frequency_hz = 0;
  double decay_per_s = 0;
  double sine = 0, cosine = 0;

  [[nodiscard]] double amplitude() const;
  [[nodiscard]] double t60_s() const;  // log(1000) / decay
};

// The damped sinusoid that fits `samples` best (least squares, Gauss-Newton from the highest spectral peak). For a
// signal that is one; with float samples good to about 1e-7 of each quantity. Frequencies from one cycle in
// `samples` to Nyquist.
DampedSinusoid fit_damped_sinusoid(std::span<const double> samples, double sample_rate_hz);

// 20 log10(|signal - reference| / |reference|), Euclidean norms over the common length. -inf when equal.
double relative_error_db(std::span<const double> signal, std::span<const double> reference);

// Largest |s[n] - s[n-1]| for n in [begin, end).
double largest_step(std::span<const double> samples, std::size_t begin, std::size_t end);

// Largest |s[n]|.
double peak(std::span<const double> samples);

// The discrete Fourier transform; the length is a power of two.
std::vector<std::complex<double>> fourier(std::vector<std::complex<double>> values);

// Level of a Hann-windowed signal at frequencies k * sample_rate / size, k = 0 ... size/2, as linear amplitudes: a sine
// of amplitude 1 that fills the signal shows a peak of 1. `size` is the signal's length rounded up to a power of two.
struct Spectrum {
  double bin_hz = 0;
  std::vector<double> magnitude;
};
Spectrum spectrum(std::span<const double> samples, double sample_rate_hz);

Samples to_doubles(std::span<const float> samples);

}  // namespace ringdown::test
