#include "server/session/loudness.h"

#include <ebur128.h>

#include <algorithm>
#include <cmath>
#include <new>

namespace ringdown::session {

struct Loudness::State {
  ebur128_state* meter = nullptr;
  std::vector<float> frames;  // of one piece, left and right in turns
  ~State() { ebur128_destroy(&meter); }
};

Loudness::Loudness(double sample_rate_hz) : state_(std::make_unique<State>()) {
  state_->meter =
      ebur128_init(2, static_cast<unsigned long>(std::lround(sample_rate_hz)), EBUR128_MODE_I | EBUR128_MODE_TRUE_PEAK);
  if (!state_->meter) throw std::bad_alloc();  // the only reason at the sample rates of a rendering
}
Loudness::Loudness(Loudness&&) noexcept = default;
Loudness& Loudness::operator=(Loudness&&) noexcept = default;
Loudness::~Loudness() = default;

void Loudness::add(std::span<const float> left, std::span<const float> right) {
  std::vector<float>& frames = state_->frames;
  frames.clear();
  for (std::size_t n = 0; n < left.size(); ++n) {
    frames.push_back(left[n]);
    frames.push_back(right[n]);
  }
  if (ebur128_add_frames_float(state_->meter, frames.data(), left.size()) != EBUR128_SUCCESS) throw std::bad_alloc();
}

std::optional<double> Loudness::lufs() const {
  double value = 0;
  if (ebur128_loudness_global(state_->meter, &value) != EBUR128_SUCCESS || !std::isfinite(value)) return {};
  return value;
}

double Loudness::true_peak() const {
  double left = 0, right = 0;
  ebur128_true_peak(state_->meter, 0, &left);
  ebur128_true_peak(state_->meter, 1, &right);
  return std::max(left, right);
}

}  // namespace ringdown::session
