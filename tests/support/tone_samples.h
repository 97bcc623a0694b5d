// A damped sinusoid as samples, to compare a fit with what was fitted.
#pragma once

#include "tests/support/signal.h"

#include <cmath>
#include <numbers>

namespace ringdown::test {

inline Samples samples_of(const DampedSinusoid& tone, double sample_rate_hz, std::size_t count) {
  Samples samples(count);
  for (std::size_t n = 0; n < count; ++n) {
    const double t = static_cast<double>(n) / sample_rate_hz, angle = 2 * std::numbers::pi * tone.frequency_hz * t;
    samples[n] = std::exp(-tone.decay_per_s * t) * (tone.sine * std::sin(angle) + tone.cosine * std::cos(angle));
  }
  return samples;
}

}  // namespace ringdown::test
