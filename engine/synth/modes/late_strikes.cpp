#include "engine/synth/modes/late_strikes.h"

#include <algorithm>

namespace ringdown::synth {

LateStrikes::LateStrikes(const ModeTable& table) : states_(table), groups_(table.groups()), listed_(table.groups()) {}

void LateStrikes::list_all() REALTIME {
  if (has_all()) return;
  groups_.clear();
  for (std::uint32_t group = 0; group < states_.table().groups(); ++group) groups_.push(group);
  std::fill_n(listed_.data(), listed_.size(), std::uint8_t{1});
}

void LateStrikes::add(BlowAmplitudes blow, double gain, const ModeFactors* each) REALTIME {
  states_.add_strike(blow, gain, each);
  list_all();
}

void LateStrikes::add(BlowAmplitudes blow, double gain, std::uint32_t group, const ModeFactors* each) REALTIME {
  states_.add_strike(blow, gain, group, each);
  if (has(group)) return;
  listed_[group] = 1;
  groups_.push(group);
}

bool LateStrikes::render(double* out, std::size_t frames) REALTIME {
  ActiveGroups all = groups_.active();
  const Hearing* const hearing = states_.for_kernel(0).hearing;
  // The tables' gains move from run to run, and their pitches not at all.
  if (hearing != nullptr && (hearing->rate != 1 || hearing->step_re != nullptr)) return drive({}, out, frames);
  return render_modes(states_.for_kernel(frames), all, kKeepAllGroups, out, frames);
}

bool LateStrikes::drive(std::span<const Force> forces, double* out, std::size_t frames) REALTIME {
  list_all();
  return drive_modes(states_.for_kernel(0), states_.table().columns(), forces, out, frames) <= kAbsurdEnergy;
}

void LateStrikes::clear() REALTIME {
  if (has_all()) {
    states_.clear();
    std::fill_n(listed_.data(), listed_.size(), std::uint8_t{0});
    return groups_.clear();
  }
  for (const std::uint32_t group : groups_) {
    states_.clear(group);
    listed_[group] = 0;
  }
  groups_.clear();
}

}  // namespace ringdown::synth
