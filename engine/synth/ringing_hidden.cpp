#include "engine/synth/ringing.h"

#include <algorithm>
#include <cmath>

namespace ringdown::synth {
namespace {

constexpr EnergyLimits kKeepAll{-1, Ringing::kAbsurdEnergy};
constexpr Level kHysteresis = 2;  // 3 dB: what wavers about the cut does not come and go

double loudest(const std::array<double, kModePadding>& energies) RINGDOWN_REALTIME {
  return *std::max_element(energies.begin(), energies.end());
}

}  // namespace

Ringing::Energies Ringing::energies_of(std::uint32_t group) const RINGDOWN_REALTIME {
  const std::size_t first = std::size_t{group} * kModePadding;
  const double *re = row(z_re) + first, *im = row(z_im) + first;
  Energies energies;
  for (std::size_t i = 0; i < kModePadding; ++i) energies[i] = re[i] * re[i] + im[i] * im[i];
  return energies;
}

// Whether one of the modes is loud enough.
bool Ringing::passes(const Energies& energies, std::uint32_t group, Level shift) const RINGDOWN_REALTIME {
  const EarBand* const band = table_.ear_bands() + std::size_t{group} * kModePadding;
  if (table_.narrow(group)) return cut_->passes(band[0], level_of(loudest(energies)) + shift);
  for (std::size_t i = 0; i < kModePadding; ++i) {
    if (cut_->passes(band[i], level_of(energies[i]) + shift)) return true;
  }
  return false;
}

// By how much a hidden group has fallen since.
Level Ringing::fallen(std::uint32_t group) const RINGDOWN_REALTIME {
  const auto since = static_cast<float>(clock_ - hidden_since_.data()[group]);
  return static_cast<Level>(std::min(since * table_.fall(group), 1e4f));
}

void Ringing::survey(Hearing& hearing, Level shift, double floor) RINGDOWN_REALTIME {
  settle();
  const auto note = [&](const Energies& energies, std::uint32_t group, Level by) RINGDOWN_REALTIME {
    const EarBand* const band = table_.ear_bands() + std::size_t{group} * kModePadding;
    const auto most = std::max_element(energies.begin(), energies.end());
    const Level level = level_of(*most) + by;
    hearing.note_group(band[most - energies.begin()], level, kModePadding);
    if (table_.narrow(group)) return hearing.note(band[0], level, kModePadding);
    for (std::size_t i = 0; i < kModePadding; ++i) hearing.note(band[i], level_of(energies[i]) + by);
  };
  for (const ActiveGroups* groups : {&slow_, &fast_}) {
    for (std::size_t i = 0; i < groups->count; ++i) note(energies_of(groups->list[i]), groups->list[i], shift);
  }
  const Level lowest = level_of(floor * floor / kModePadding);  // as EnergyCheck has it
  hidden_.keep([&](std::uint32_t group) RINGDOWN_REALTIME {
    const Energies energies = energies_of(group);
    const Level lower = fallen(group);
    const bool keep = level_of(loudest(energies)) - lower >= lowest;
    const std::size_t first = std::size_t{group} * kModePadding;
    if (keep) return note(energies, group, shift - lower), true;
    for (const Row which : {z_re, z_im}) std::fill_n(row(which) + first, kModePadding, 0.0);
    return false;
  });
}

void Ringing::attend(const Cut& cut, Level shift) RINGDOWN_REALTIME {
  cut_ = cut.hides ? &cut : nullptr;
  shift_ = shift;
}

void Ringing::listen(const Cut& cut, Level shift, std::size_t& most_coming) RINGDOWN_REALTIME {
  attend(cut, shift);
  const bool was_missed = missed();
  cut_number_ = cut.number;
  if (!selective()) return;
  cut_ = &cut;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < slow_.count; ++i) {
    const std::uint32_t group = slow_.list[i];
    if (passes(energies_of(group), group, shift)) {
      slow_.list[kept++] = group;
    } else {
      leaving_.put(group);
    }
  }
  slow_.count = kept;
  hidden_.keep([&](std::uint32_t group) RINGDOWN_REALTIME {
    if (most_coming < kModePadding) return true;
    if (!passes(energies_of(group), group, shift - fallen(group) - kHysteresis)) return true;
    most_coming -= kModePadding;
    catch_up(group);
    coming_.put(group);
    return false;
  });
  if (!cut.hides) cut_ = nullptr;
  if (was_missed && most_coming < kModePadding) cut_number_ = kNoCut;
}

void Ringing::miss(std::size_t frames) RINGDOWN_REALTIME {
  settle();
  cut_number_ = kNoCut;
  for (std::size_t i = 0; i < slow_.count; ++i) hide(slow_.list[i]);
  slow_.count = 0;
  for (std::size_t i = 0; i < fast_.count; ++i) skip_group(z_re, z_im, fast_.list[i], frames);
  if (fade_left_ > 0) {
    skip_modes(modes(fade_re, fade_im, 0), table_.columns(), frames);
    fade_left_ -= std::min(frames, fade_left_);
    if (fade_left_ == 0) clear_row(fade_re), clear_row(fade_im);
  }
  clock_ += static_cast<Frame>(frames);
}

void Ringing::hide(std::uint32_t group) RINGDOWN_REALTIME {
  hidden_since_.data()[group] = clock_;
  hidden_.put(group);
}

// Moves a hidden group's states to clock_.
void Ringing::catch_up(std::uint32_t group) RINGDOWN_REALTIME {
  skip_group(z_re, z_im, group, static_cast<std::uint64_t>(clock_ - hidden_since_.data()[group]));
}

void Ringing::skip_group(Row re, Row im, std::uint32_t group, std::uint64_t frames) RINGDOWN_REALTIME {
  const std::size_t first = std::size_t{group} * kModePadding;
  ModeArrays here = modes(re, im, 0);
  here.z_re += first, here.z_im += first, here.pole_re += first, here.pole_im += first;
  skip_modes(here, kModePadding, frames);
}

// What `other` brings to hidden groups stays hidden when it is too quiet.
void Ringing::add_selectively(const Ringing& other, double gain) RINGDOWN_REALTIME {
  settle();
  mark();
  hidden_.clear();
  slow_.count = fast_.count = 0;
  for (std::uint32_t group = 0; group < table_.groups(); ++group) {
    const State state = state_.data()[group];
    if (state == State::hidden) catch_up(group);
    const std::size_t first = std::size_t{group} * kModePadding;
    for (const Row which : {z_re, z_im}) {
      double* const mine = row(which) + first;
      const double* const theirs = other.row(which) + first;
      for (std::size_t i = 0; i < kModePadding; ++i) mine[i] += gain * theirs[i];
    }
    if (group >= table_.slow_groups()) {
      fast_.list[fast_.count++] = group;
    } else if (state == State::sounding || !cut_ || passes(energies_of(group), group, shift_)) {
      sound(group);
    } else {
      hide(group);
    }
  }
}

// Lets what was about to come or go sound from now on.
void Ringing::settle() RINGDOWN_REALTIME {
  for (Groups* groups : {&leaving_, &coming_}) {
    for (std::size_t i = 0; i < groups->size(); ++i) sound((*groups)[i]);
    groups->clear();
  }
}

void Ringing::reveal() RINGDOWN_REALTIME {
  settle();
  for (std::size_t i = 0; i < hidden_.size(); ++i) {
    catch_up(hidden_[i]);
    sound(hidden_[i]);
  }
  hidden_.clear();
}

bool Ringing::add_changes(std::size_t frames, std::span<const MomentTarget> targets) RINGDOWN_REALTIME {
  const ModeArrays all = modes(z_re, z_im, frames);
  ActiveGroups leaving = leaving_.active(), coming = coming_.active();
  bool sane = add_moments(all, table_.moments(), leaving, frames, kKeepAll, targets, {1, 0});
  sane = add_moments(all, table_.moments(), coming, frames, kKeepAll, targets, {0, 1}) && sane;
  finish_changes(frames);
  return sane;
}

bool Ringing::render_changes(double* out, std::size_t frames) RINGDOWN_REALTIME {
  double down[kChunkFrames] = {}, up[kChunkFrames] = {};
  ActiveGroups leaving = leaving_.active(), coming = coming_.active();
  bool sane = render_modes(modes(z_re, z_im, frames), leaving, kKeepAll, down, frames);
  sane = render_modes(modes(z_re, z_im, frames), coming, kKeepAll, up, frames) && sane;
  for (std::size_t n = 0; n < frames; ++n) {
    const double level = static_cast<double>(n) / static_cast<double>(frames);
    out[n] += (1 - level) * down[n] + level * up[n];
  }
  finish_changes(frames);
  return sane;
}

// The states have moved on by `frames`, and clock_ not yet.
void Ringing::finish_changes(std::size_t frames) RINGDOWN_REALTIME {
  const auto end = clock_ + static_cast<Frame>(frames);
  for (std::size_t i = 0; i < leaving_.size(); ++i) {
    hidden_since_.data()[leaving_[i]] = end;
    hidden_.put(leaving_[i]);
  }
  for (std::size_t i = 0; i < coming_.size(); ++i) sound(coming_[i]);
  leaving_.clear();
  coming_.clear();
}

}  // namespace ringdown::synth
