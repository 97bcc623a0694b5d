#include "engine/synth/ringing.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

namespace ringdown::synth {
namespace {

constexpr EnergyLimits kKeepAll{-1, Ringing::kAbsurdEnergy};

}  // namespace

Ringing::Ringing(const ModeTable& table)
    : table_(table),
      states_(aligned_zeros<double>(kRows * table.columns())),
      hidden_(table.slow_groups()),
      leaving_(table.slow_groups()),
      coming_(table.slow_groups()),
      hidden_since_(table.slow_groups()),
      state_(table.groups()) {
  for (std::vector<std::uint32_t>* list : {&groups_, &aside_groups_, &fade_groups_}) {
    list->resize(table.groups());
    std::iota(list->begin(), list->end(), 0);
  }
  slow_.list = groups_.data();
  fast_.list = groups_.data() + table.slow_groups();
}

// a sin(omega t) = Re(-i a exp(i omega t)): a strike lowers the imaginary part of z.
void Ringing::add(const double* amplitudes, double gain) RINGDOWN_REALTIME {
  if (selective()) return add_listening(amplitudes, gain);
  double* const im = row(z_im);
  for (std::size_t i = 0; i < table_.columns(); ++i) im[i] -= gain * amplitudes[i];
  wake();
}

void Ringing::add(Ringing& other, double gain) RINGDOWN_REALTIME {
  assert(&table_ == &other.table_);
  other.reveal();
  if (selective()) return add_selectively(other, gain);
  for (const Row which : {z_re, z_im}) {
    double* const mine = row(which);
    const double* const theirs = other.row(which);
    for (std::size_t i = 0; i < table_.columns(); ++i) mine[i] += gain * theirs[i];
  }
  wake();
}

void Ringing::wake() RINGDOWN_REALTIME {
  reveal();
  slow_.count = table_.slow_groups();
  fast_.count = table_.groups() - slow_.count;
  std::iota(slow_.list, slow_.list + table_.groups(), 0);
}

void Ringing::rest() RINGDOWN_REALTIME {
  reveal();
  cut_ = nullptr;
  slow_.count = fast_.count = 0;
}

bool Ringing::take_over(Ringing& other) RINGDOWN_REALTIME {
  reveal();
  other.reveal();
  bool left = false;
  for (const Row which : {z_re, z_im, fade_re, fade_im}) {
    double* const mine = row(which);
    double* const theirs = other.row(which);
    for (std::size_t i = 0; i < table_.playable_modes(); ++i) {
      const std::optional<std::size_t> from = other.table_.column_of(table_.mode_of(i));
      mine[table_.column(i)] = from ? std::exchange(theirs[*from], 0.0) : 0.0;
    }
    for (std::size_t i = 0; i < other.table_.columns(); ++i) left = left || theirs[i] != 0;
  }
  const double ratio = table_.sample_rate_hz() / other.table_.sample_rate_hz();
  const auto scaled = [ratio](std::size_t frames) RINGDOWN_REALTIME {
    return static_cast<std::size_t>(std::ceil(static_cast<double>(frames) * ratio));
  };
  fade_frames_ = std::max(kFadeFrames, scaled(other.fade_frames_));
  fade_left_ = std::min(scaled(other.fade_left_), fade_frames_);
  if (other.slow_.count + other.fast_.count > 0) wake();
  return left;
}

void Ringing::fade_out(std::size_t frames) RINGDOWN_REALTIME {
  // A fade may still be running: what is left of it joins the new one at its present level.
  reveal();
  const double level = static_cast<double>(fade_left_) / static_cast<double>(fade_frames_);
  for (const auto& [from, to] : {std::pair{z_re, fade_re}, std::pair{z_im, fade_im}}) {
    for (std::size_t i = 0; i < table_.columns(); ++i) {
      row(to)[i] = level * row(to)[i] + row(from)[i];
      row(from)[i] = 0;
    }
  }
  fade_left_ = fade_frames_ = std::max(frames, kFadeFrames);
  rest();
}

bool Ringing::render(double* out, std::size_t frames, double floor) RINGDOWN_REALTIME {
  const EnergyLimits limits{floor * floor, kAbsurdEnergy};
  bool sane = fade_left_ == 0 || render_fade(out, frames);
  for (ActiveGroups* groups : {&slow_, &fast_}) {
    if (groups->count > 0) sane = render_modes(modes(z_re, z_im, frames), *groups, limits, out, frames) && sane;
  }
  if (leaving_.size() + coming_.size() > 0) sane = render_changes(out, frames) && sane;
  clock_ += static_cast<Frame>(frames);
  return keep_if(sane);
}

bool Ringing::render_together(std::span<const MomentTarget> targets, double* out, std::size_t frames,
                              double floor) RINGDOWN_REALTIME {
  const EnergyLimits limits{floor * floor, kAbsurdEnergy};
  const ModeArrays all = modes(z_re, z_im, frames);
  bool sane = fade_left_ == 0 || render_fade(out, frames);
  if (fast_.count > 0) sane = render_modes(all, fast_, limits, out, frames) && sane;
  if (slow_.count > 0) sane = add_moments(all, table_.moments(), slow_, frames, limits, targets) && sane;
  if (leaving_.size() + coming_.size() > 0) sane = add_changes(frames, targets) && sane;
  clock_ += static_cast<Frame>(frames);
  return keep_if(sane);
}

bool Ringing::keep_if(bool sane) RINGDOWN_REALTIME {
  if (!sane) silence();
  return sane;
}

void Ringing::skip(Frame frames) RINGDOWN_REALTIME {
  reveal();
  if (frames > 0) skip_modes(modes(z_re, z_im, 0), table_.columns(), static_cast<std::uint64_t>(frames));
}

bool Ringing::render_fade(double* out, std::size_t frames) RINGDOWN_REALTIME {
  double sum[kChunkFrames] = {};
  ActiveGroups all{fade_groups_.data(), fade_groups_.size()};
  const bool sane = render_modes(modes(fade_re, fade_im, frames), all, kKeepAll, sum, frames);
  for (std::size_t n = 0; n < frames && fade_left_ > 0; ++n, --fade_left_) {
    out[n] += sum[n] * static_cast<double>(fade_left_) / static_cast<double>(fade_frames_);
  }
  if (fade_left_ == 0) clear_row(fade_re), clear_row(fade_im);
  return sane;
}

std::size_t Ringing::sounding_modes() const RINGDOWN_REALTIME {
  return std::min(kModePadding * slow_.count, table_.slow_modes()) +
         std::min(kModePadding * fast_.count, table_.playable_modes() - table_.slow_modes());
}

void Ringing::silence() RINGDOWN_REALTIME {
  for (const Row which : {z_re, z_im, aside_re, aside_im, fade_re, fade_im}) clear_row(which);
  for (Groups* groups : {&hidden_, &leaving_, &coming_}) groups->clear();
  slow_.count = fast_.count = aside_count_ = 0;
  fade_left_ = 0;
}

void Ringing::clear_row(Row which) RINGDOWN_REALTIME { std::fill_n(row(which), table_.columns(), 0.0); }

}  // namespace ringdown::synth
