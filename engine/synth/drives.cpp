#include "engine/synth/drives.h"

#include <limits>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::synth {

// The sum of sin(pi n / frames) over 0 <= n <= frames, by adding up exponentials.
HalfSine::HalfSine(double frames) RINGDOWN_REALTIME : frames_(frames) {
  const double half_step = 0.5 * std::numbers::pi / frames, last = std::floor(frames);
  scale_ = std::sin(half_step) / (std::sin(half_step * last) * std::sin(half_step * (last + 1)));
}

void HalfSine::fill(Frame first, std::size_t count, double* impulses) const RINGDOWN_REALTIME {
  for (std::size_t i = 0; i < count; ++i) {
    const double n = static_cast<double>(first) + static_cast<double>(i);
    impulses[i] = n >= 0 && n < frames_ ? scale_ * std::sin(std::numbers::pi * n / frames_) : 0.0;
  }
}

void Drive::fill(Frame first, std::size_t count, const float* samples, double* impulses) RINGDOWN_REALTIME {
  if (!input) {
    const auto left = std::clamp<Frame>(end - first, 0, static_cast<Frame>(count));
    if (contact) {
      rubbing.fill(first, static_cast<std::size_t>(left), impulses);
    } else {
      pulse.fill(first - place.frame, static_cast<std::size_t>(left), impulses);
    }
    std::fill(impulses + left, impulses + count, 0.0);
  } else if (samples) {
    std::copy_n(samples, count, impulses);
  } else {
    std::fill_n(impulses, count, 0.0);
  }
}

void Drive::rescale(Frame now, double ratio) {
  const auto moved = [now, ratio](Frame frame) {
    return now + static_cast<Frame>(std::llround(static_cast<double>(frame - now) * ratio));
  };
  if (input) {
    place.impulse_ns = (1 / ratio) * place.impulse_ns;
    return;
  }
  place.frame = moved(place.frame);
  if (end != std::numeric_limits<Frame>::max()) end = moved(end);
  if (contact) {
    rubbing.rescale(now, ratio);
  } else {
    pulse = pulse.stretched(ratio);
  }
}

}  // namespace ringdown::synth
