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

double Ringing::reach_at_rest(Frame frames) const RINGDOWN_REALTIME {
  double sum = 0;
  for (std::uint32_t group = 0; group < table_.groups(); ++group) {
    const double steps = static_cast<double>(frames) * static_cast<double>(table_.fall(group));
    sum += after_fall(steps) * amplitudes_of(group);
  }
  return sum;
}

// Of states that have rested for so many frames.
void Ringing::add_group(std::uint32_t group, double gain, double frames, ModeWatch::Place& to) const RINGDOWN_REALTIME {
  const ModeArrays all = modes(z_re, z_im, 0);
  const std::size_t first = std::size_t{group} * kModePadding;
  for (std::size_t c = first; c < first + kModePadding; ++c) {
    const std::optional<std::size_t> i = table_.at_column(c);
    const double energy = all.z_re[c] * all.z_re[c] + all.z_im[c] * all.z_im[c];
    if (!i || energy == 0) continue;
    const double pole = all.pole_re[c] * all.pole_re[c] + all.pole_im[c] * all.pole_im[c];
    const double rest = frames > 0 ? std::pow(pole, 0.5 * frames) : 1;
    to.add(table_.mode_of(*i), gain * rest * std::sqrt(energy));
  }
}

void Ringing::add_amplitudes_at_rest(double gain, Frame frames, ModeWatch::Place& to) const RINGDOWN_REALTIME {
  for (std::uint32_t group = 0; group < table_.groups(); ++group)
    add_group(group, gain, static_cast<double>(frames), to);
}

void Ringing::add_amplitudes(double gain, ModeWatch::Place& to) const RINGDOWN_REALTIME {
  for (const ActiveGroups* groups : {&slow_, &fast_}) {
    for (std::size_t i = 0; i < groups->count; ++i) add_group(groups->list[i], gain, 0, to);
  }
  for (const Groups* groups : {&leaving_, &coming_}) {
    for (std::size_t i = 0; i < groups->size(); ++i) add_group((*groups)[i], gain, 0, to);
  }
  for (std::size_t i = 0; i < hidden_.size(); ++i) {
    add_group(hidden_[i], gain, static_cast<double>(clock_ - hidden_since_.data()[hidden_[i]]), to);
  }
  if (fade_left_ == 0) return;
  const double left = static_cast<double>(fade_left_) / static_cast<double>(fade_frames_);
  const double *re = row(fade_re), *im = row(fade_im);
  for (std::size_t i = 0; i < table_.playable_modes(); ++i) {
    const std::size_t c = table_.column(i);
    to.add(table_.mode_of(i), gain * left * std::sqrt(re[c] * re[c] + im[c] * im[c]));
  }
}

}  // namespace ringdown::synth
