// Groups of modes that are not computed because there is no time for them.
//
// A muted group keeps its states as they were and knows since when, so it is moved on in one jump, exactly, when it is
// wanted again, and it comes back as if it had sounded all the time. Groups leave and enter by a ramp over the frames
// that are rendered next. Only groups that take moments (ModeTable::slow_groups) are ever muted.
// [audio, after construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/modes/probes.h"
#include "engine/synth/modes/state_array.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ringdown::synth {

// The energy of a group (the sum of |z|^2, full scale 1) in eighths of an octave: steps of 0.28 to 0.51 dB. What is not
// a number lies above everything.
using Level = std::int32_t;
inline constexpr double kStep_db = 0.37628749457997270;  // 10 log10(2) / 8
Level level_of(double energy) REALTIME;
inline constexpr Level kNoThreshold = -100000;  // below which nothing lies

// Some groups of a table.
class GroupList {
 public:
  explicit GroupList(std::size_t capacity) : groups_(capacity) {}
  [[nodiscard]] std::size_t size() const REALTIME { return count_; }
  [[nodiscard]] const std::uint32_t* begin() const REALTIME { return groups_.data(); }
  [[nodiscard]] const std::uint32_t* end() const REALTIME { return groups_.data() + count_; }
  void push(std::uint32_t group) REALTIME { groups_[count_++] = group; }
  void clear() REALTIME { count_ = 0; }
  // Keeps the groups of which `wanted(group)` is true, in their order.
  template <class Wanted>
  void keep_if(const Wanted& wanted) REALTIME {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const std::uint32_t group = groups_[i];
      if (wanted(group)) groups_[kept++] = group;
    }
    count_ = kept;
  }
  [[nodiscard]] ActiveGroups active() REALTIME { return {groups_.data(), count_}; }

 private:
  std::vector<std::uint32_t> groups_;
  std::size_t count_ = 0;
};

class Muting {
 public:
  explicit Muting(const ModeTable& table);  // [worker]

  // Mutes a group from the present frame on.
  void mute(const StateArray& states, std::uint32_t group) REALTIME {
    measure(states, group);
    muted.push(group);
  }
  // Notes the level of a group whose states are those of the present frame.
  void measure(const StateArray& states, std::uint32_t group) REALTIME;
  // The level of a muted group now: what measure() found, less the slowest decay among its modes.
  [[nodiscard]] Level level(std::uint32_t group) const REALTIME;
  // By how many frames the states of a group are behind; 0 unless it is muted.
  [[nodiscard]] Frame frames_behind(std::uint32_t group) const REALTIME {
    return group < muted_at_.size() && muted_at_[group] != kNotMuted ? clock_ - muted_at_[group] : 0;
  }
  // Moves a muted group's states to the present frame. The caller takes the group off the list, or measures it.
  void catch_up(StateArray& states, std::uint32_t group) REALTIME;
  // Gives a muted group up: it has died away. The caller takes it off the list.
  void forget(StateArray& states, std::uint32_t group) REALTIME;

  // Returns true if groups leave or enter in the next rendered frames.
  [[nodiscard]] bool changing() const REALTIME { return leaving.size() + entering.size() > 0; }
  // Adds the sound of the groups that leave and enter: as samples, by tables, or as moments. Their states move on by
  // `frames`. False when a state is absurd.
  bool render_changes(StateArray& states, double* out, std::size_t frames) REALTIME;
  bool render_changes(StateArray& states, std::span<const MomentTarget> targets, std::size_t frames) REALTIME;
  // Adds what probes feel of these groups.
  void feel(const StateArray& states, const Probes& probes, std::size_t frames) REALTIME;
  // Ends a chunk of `frames`. What has left is muted, and what has entered is appended to `sounding`.
  void advance(const StateArray& states, std::size_t frames, ActiveGroups& sounding) REALTIME {
    clock_ += static_cast<Frame>(frames);
    if (changing()) finish_changes(states, sounding);
  }

  // Returns true if each group is decided by itself, because there is a threshold or something is muted.
  [[nodiscard]] bool chooses(Level threshold) const REALTIME { return threshold != kNoThreshold || groups() > 0; }
  [[nodiscard]] std::size_t groups() const REALTIME { return muted.size() + leaving.size() + entering.size(); }
  void clear() REALTIME;

  GroupList muted, leaving, entering;  // the latter two by a ramp in the next rendered frames

 private:
  void finish_changes(const StateArray& states, ActiveGroups& sounding) REALTIME;

  static constexpr Frame kNotMuted = -1;
  std::vector<Frame> muted_at_;     // by clock_
  std::vector<Level> muted_level_;  // the level it had then
  std::vector<float> fall_;         // Levels per frame by which each slow group falls, at least
  Frame clock_ = 0;                 // frames rendered
};

}  // namespace ringdown::synth
