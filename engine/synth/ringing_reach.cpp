#include "engine/synth/ringing.h"

#include <cmath>
#include <numbers>

namespace ringdown::synth {
namespace {

// What `steps` of Level leave of an amplitude.
double after_fall(double steps) RINGDOWN_REALTIME { return std::exp(-steps * kStep_db * std::numbers::ln10 / 20); }

}  // namespace

double Ringing::amplitudes_of(std::uint32_t group) const RINGDOWN_REALTIME {
  double sum = 0;
  for (const double energy : energies_of(group)) sum += std::sqrt(energy);
  return sum;
}

double Ringing::reach() const RINGDOWN_REALTIME {
  double sum = 0;
  for (const ActiveGroups* groups : {&slow_, &fast_}) {
    for (std::size_t i = 0; i < groups->count; ++i) sum += amplitudes_of(groups->list[i]);
  }
  for (const Groups* groups : {&leaving_, &coming_}) {
    for (std::size_t i = 0; i < groups->size(); ++i) sum += amplitudes_of((*groups)[i]);
  }
  for (std::size_t i = 0; i < hidden_.size(); ++i) {
    const std::uint32_t group = hidden_[i];
    const auto since = static_cast<double>(clock_ - hidden_since_.data()[group]);
    sum += after_fall(since * static_cast<double>(table_.fall(group))) * amplitudes_of(group);
  }
  if (fade_left_ == 0) return sum;
  double fading = 0;
  const double *re = row(fade_re), *im = row(fade_im);
  for (std::size_t i = 0; i < table_.columns(); ++i) fading += std::sqrt(re[i] * re[i] + im[i] * im[i]);
  return sum + fading * static_cast<double>(fade_left_) / static_cast<double>(fade_frames_);
}

double Ringing::reach_at_rest(protocol::Frame frames) const RINGDOWN_REALTIME {
  double sum = 0;
  for (std::uint32_t group = 0; group < table_.groups(); ++group) {
    const double steps = static_cast<double>(frames) * static_cast<double>(table_.fall(group));
    sum += after_fall(steps) * amplitudes_of(group);
  }
  return sum;
}

}  // namespace ringdown::synth
