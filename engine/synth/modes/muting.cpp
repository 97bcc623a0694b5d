#include "engine/synth/modes/muting.h"

#include <algorithm>
#include <bit>
#include <numbers>

namespace ringdown::synth {

// Muting is lazy: a muted group is never visited until it is wanted. It keeps the states of the frame at which it was
// muted, that frame, and its level then. Its level now follows from the slowest decay among its modes, so it is an
// upper bound, and finding it costs one product; catch_up() moves the states by p^n, in about 2 log2(n) products.
//
// The exponent and the three leading bits of the mantissa of a float count eighths of an octave, nearly.
Level level_of(double energy) REALTIME {
  constexpr std::uint32_t kOne = 127u << 3;  // the level of an energy of 1 is 0
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(static_cast<float>(energy)) & 0x7fffffffu;
  return static_cast<Level>(bits >> 20) - static_cast<Level>(kOne);
}

Muting::Muting(const ModeTable& table)
    : muted(table.slow_groups()),
      leaving(table.slow_groups()),
      entering(table.slow_groups()),
      muted_at_(table.slow_groups(), kNotMuted),
      muted_level_(table.slow_groups()) {
  constexpr double kLevelsPerNeper = 20 / std::numbers::ln10 / kStep_db;
  for (std::uint32_t group = 0; group < table.slow_groups(); ++group) {
    fall_.push_back(static_cast<float>(kLevelsPerNeper * table.slowest_decay(group)));
  }
}

void Muting::measure(const StateArray& states, std::uint32_t group) REALTIME {
  muted_at_[group] = clock_;
  muted_level_[group] = level_of(states.energy(group));
}

Level Muting::level(std::uint32_t group) const REALTIME {
  const auto behind = static_cast<float>(frames_behind(group));
  const float fall = behind * fall_[group];
  return muted_level_[group] - static_cast<Level>(std::min(fall, 1e5f));
}

void Muting::catch_up(StateArray& states, std::uint32_t group) REALTIME {
  states.skip(static_cast<std::uint64_t>(frames_behind(group)), group);
  muted_at_[group] = kNotMuted;
}

void Muting::forget(StateArray& states, std::uint32_t group) REALTIME {
  states.clear(group);
  muted_at_[group] = kNotMuted;
}

namespace {

// Adds samples of what leaves and of what enters, under their ramps.
void add_changes(const double* down, const double* up, double* out, std::size_t frames) REALTIME {
  for (std::size_t n = 0; n < frames; ++n) {
    const double level = static_cast<double>(n) / static_cast<double>(frames);
    out[n] += (1 - level) * down[n] + level * up[n];
  }
}

}  // namespace

bool Muting::render_changes(StateArray& states, double* out, std::size_t frames) REALTIME {
  double down[kChunkFrames] = {}, up[kChunkFrames] = {};
  ActiveGroups going = leaving.active(), coming = entering.active();
  bool sane = render_modes(states.for_kernel(frames), going, kKeepAllGroups, down, frames);
  sane = render_modes(states.for_kernel(frames), coming, kKeepAllGroups, up, frames) && sane;
  add_changes(down, up, out, frames);
  return sane;
}

void Muting::feel(const StateArray& states, const Probes& probes, std::size_t frames) REALTIME {
  for (const Probes::One& probe : probes.all()) {
    double down[kChunkFrames] = {}, up[kChunkFrames] = {};
    probes.ring(probe, states, leaving.active(), down, frames);
    probes.ring(probe, states, entering.active(), up, frames);
    add_changes(down, up, probe.to, frames);
  }
}

bool Muting::render_changes(StateArray& states, std::span<const MomentTarget> targets, std::size_t frames) REALTIME {
  const ModeArrays all = states.for_kernel(frames);
  const MomentArrays moments = states.moments();
  ActiveGroups going = leaving.active(), coming = entering.active();
  const bool sane = add_moments(all, moments, going, frames, kKeepAllGroups, targets, {1, 0});
  return add_moments(all, moments, coming, frames, kKeepAllGroups, targets, {0, 1}) && sane;
}

void Muting::finish_changes(const StateArray& states, ActiveGroups& sounding) REALTIME {
  for (const std::uint32_t group : leaving) mute(states, group);
  for (const std::uint32_t group : entering) sounding.list[sounding.count++] = group;
  leaving.clear();
  entering.clear();
}

void Muting::clear() REALTIME {
  for (const std::uint32_t group : muted) muted_at_[group] = kNotMuted;
  for (GroupList* groups : {&muted, &leaving, &entering}) groups->clear();
}

}  // namespace ringdown::synth
