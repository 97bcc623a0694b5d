#include "engine/synth/ringing.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace ringdown::synth {
namespace {

constexpr EnergyLimits kKeepAll{-1, Ringing::kAbsurdEnergy};

}  // namespace

// Whether a strike is loud enough, or wrong enough, to be computed at once.
bool Ringing::wakes(const double* amplitudes, double gain, std::uint32_t group) const RINGDOWN_REALTIME {
  if (!cut_) return true;
  const double* const a = amplitudes + std::size_t{group} * kModePadding;
  Energies energies;
  double sum = 0;
  for (std::size_t i = 0; i < kModePadding; ++i) sum += energies[i] = gain * gain * a[i] * a[i];
  return !(sum <= kAbsurdEnergy) || passes(energies, group, shift_);
}

// What each group does now, into state_.
void Ringing::mark() RINGDOWN_REALTIME {
  State* const state = state_.data();
  std::fill_n(state, table_.groups(), State::resting);
  for (const ActiveGroups* groups : {&slow_, &fast_}) {
    for (std::size_t i = 0; i < groups->count; ++i) state[groups->list[i]] = State::sounding;
  }
  for (std::size_t i = 0; i < hidden_.size(); ++i) state[hidden_[i]] = State::hidden;
}

// A strike wakes a group, or is kept for later if it is too quiet.
void Ringing::add_listening(const double* amplitudes, double gain) RINGDOWN_REALTIME {
  settle();
  mark();
  State* const state = state_.data();
  hidden_.clear();
  double* const im = row(z_im);
  for (std::uint32_t group = 0; group < table_.groups(); ++group) {
    const bool slow = group < table_.slow_groups();
    if (state[group] == State::hidden) catch_up(group);
    const std::size_t first = std::size_t{group} * kModePadding;
    for (std::size_t i = first; i < first + kModePadding; ++i) im[i] -= gain * amplitudes[i];
    if (state[group] == State::sounding) continue;
    const bool loud = wakes(amplitudes, gain, group);
    if (!slow) {
      fast_.list[fast_.count++] = group;
    } else if (loud) {
      sound(group);
    } else {
      hide(group);
    }
  }
}

void Ringing::add_aside(const double* amplitudes, double gain, std::size_t left) RINGDOWN_REALTIME {
  double* const im = row(aside_im);
  if (!selective()) {
    for (std::size_t i = 0; i < table_.columns(); ++i) im[i] -= gain * amplitudes[i];
    aside_count_ = aside_groups_.size();
    std::iota(aside_groups_.data(), aside_groups_.data() + aside_count_, 0);
    return;
  }
  mark();
  State* const state = state_.data();
  for (std::size_t i = 0; i < aside_count_; ++i) state[aside_groups_.data()[i]] = State::aside;
  for (std::uint32_t group = 0; group < table_.groups(); ++group) {
    const bool loud = state[group] == State::sounding || state[group] == State::aside || wakes(amplitudes, gain, group);
    if (!loud && group < table_.slow_groups()) {
      add_quietly(group, amplitudes, gain, left);
    } else {
      const std::size_t first = std::size_t{group} * kModePadding;
      for (std::size_t i = first; i < first + kModePadding; ++i) im[i] -= gain * amplitudes[i];
      if (state[group] != State::aside) aside_groups_.data()[aside_count_++] = group;
    }
  }
}

// To a group that is hidden, or will be: what the strike will be in `left` frames, when clock_ is.
void Ringing::add_quietly(std::uint32_t group, const double* amplitudes, double gain,
                          std::size_t left) RINGDOWN_REALTIME {
  alignas(64) double re[kModePadding] = {}, im[kModePadding];
  const std::size_t first = std::size_t{group} * kModePadding;
  for (std::size_t i = 0; i < kModePadding; ++i) im[i] = -gain * amplitudes[first + i];
  ModeArrays struck = modes(z_re, z_im, 0);
  struck.z_re = re, struck.z_im = im;
  struck.pole_re += first, struck.pole_im += first;
  skip_modes(struck, kModePadding, left);
  if (state_.data()[group] == State::hidden) catch_up(group);
  for (std::size_t i = 0; i < kModePadding; ++i) row(z_re)[first + i] += re[i], row(z_im)[first + i] += im[i];
  if (state_.data()[group] == State::hidden) {
    hidden_since_.data()[group] = clock_;
  } else {
    hide(group);
  }
}

bool Ringing::render_aside(double* out, std::size_t frames) RINGDOWN_REALTIME {
  ActiveGroups all{aside_groups_.data(), aside_count_};
  return keep_if(render_modes(modes(aside_re, aside_im, frames), all, kKeepAll, out, frames));
}

bool Ringing::drive_aside(std::span<const Force> forces, double* out, std::size_t frames) RINGDOWN_REALTIME {
  aside_count_ = aside_groups_.size();
  std::iota(aside_groups_.data(), aside_groups_.data() + aside_count_, 0);
  return keep_if(drive_modes(modes(aside_re, aside_im, 0), table_.columns(), forces, out, frames) <= kAbsurdEnergy);
}

void Ringing::join() RINGDOWN_REALTIME {
  mark();
  State* const state = state_.data();
  for (std::size_t k = 0; k < aside_count_; ++k) {
    const std::uint32_t group = aside_groups_.data()[k];
    if (state[group] == State::hidden) catch_up(group);
    const std::size_t first = std::size_t{group} * kModePadding;
    for (const auto& [from, to] : {std::pair{aside_re, z_re}, std::pair{aside_im, z_im}}) {
      for (std::size_t i = first; i < first + kModePadding; ++i) row(to)[i] += std::exchange(row(from)[i], 0.0);
    }
    if (state[group] == State::sounding) continue;
    ActiveGroups& groups = group < table_.slow_groups() ? slow_ : fast_;
    groups.list[groups.count++] = group;
    state[group] = State::sounding;
  }
  hidden_.keep([state](std::uint32_t group) RINGDOWN_REALTIME { return state[group] == State::hidden; });
  aside_count_ = 0;
}

}  // namespace ringdown::synth
