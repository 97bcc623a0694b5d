// Recordings of which the truth is known, by a route of their own: closed form in long double. [any]
#pragma once

#include "engine/fit/modes.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace ringdown::test {

inline constexpr double kRate = 48000;

struct Tone {
  double frequency_hz, decay_per_s, amplitude = 1, phase_rad = 0;
};

// The tones from `onset` on, and silence before.
inline std::vector<double> struck(const std::vector<Tone>& tones, double seconds, double onset_s = 0,
                                  double rate = kRate) {
  std::vector<double> samples(static_cast<std::size_t>(seconds * rate));
  const auto onset = static_cast<std::size_t>(std::round(onset_s * rate));
  for (const Tone& tone : tones) {
    for (std::size_t n = onset; n < samples.size(); ++n) {
      const long double t = static_cast<long double>(n - onset) / rate;
      const long double angle = 2 * std::numbers::pi_v<long double> * tone.frequency_hz * t + tone.phase_rad;
      samples[n] += static_cast<double>(tone.amplitude * std::exp(-tone.decay_per_s * t) * std::sin(angle));
    }
  }
  return samples;
}

inline void add_noise(std::vector<double>& samples, double deviation, std::uint32_t seed = 1) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> noise(0, deviation);
  for (double& sample : samples) sample += noise(engine);
}

inline double rms(const std::vector<double>& samples) {
  double sum = 0;
  for (const double sample : samples) sum += sample * sample;
  return std::sqrt(sum / static_cast<double>(samples.size()));
}

inline double cents(double ratio) { return 1200 * std::log2(ratio); }

}  // namespace ringdown::test
