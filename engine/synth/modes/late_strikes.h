// States that are moved on apart from an object's others until the chunk ends: strikes in the middle of a chunk whose
// earlier sound is summed as moments, and modes under forces that last. [audio, after construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/kernels/drive_kernel.h"
#include "engine/synth/modes/muting.h"
#include "engine/synth/modes/state_array.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ringdown::synth {

class LateStrikes {
 public:
  explicit LateStrikes(const ModeTable& table);  // [worker]

  // Adds a strike's amplitudes, times `gain`, at the present frame: to all groups, or to one.
  void add(BlowAmplitudes blow, double gain, const ModeFactors* each) REALTIME;
  void add(BlowAmplitudes blow, double gain, std::uint32_t group, const ModeFactors* each) REALTIME;

  // Adds the next `frames` <= kChunkFrames samples to `out`: ringing freely, or under forces. False when a state is
  // absurd.
  bool render(double* out, std::size_t frames) REALTIME;
  bool drive(std::span<const Force> forces, double* out, std::size_t frames) REALTIME;

  [[nodiscard]] bool has(std::uint32_t group) const REALTIME { return listed_[group] != 0; }
  [[nodiscard]] bool has_all() const REALTIME { return groups_.size() == listed_.size(); }
  [[nodiscard]] const GroupList& groups() const REALTIME { return groups_; }  // that have been struck
  [[nodiscard]] ActiveGroups active() REALTIME { return groups_.active(); }
  void hear_by(const Hearing* hearing) REALTIME { states_.hear_by(hearing); }
  [[nodiscard]] const StateArray& states() const REALTIME { return states_; }
  void clear() REALTIME;

 private:
  void list_all() REALTIME;

  StateArray states_;
  GroupList groups_;
  std::vector<std::uint8_t> listed_;  // of each group: whether it stands in groups_
};

}  // namespace ringdown::synth
