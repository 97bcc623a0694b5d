// One set of states for all objects that share a table, however many ring: a thousand coins cost as much as two banks.
//
// An output receives the sum of the members' states, each times its object's gain there. While these gains are
// constant, the sum evolves like each member, because it has the members' poles; so only the sum has to be moved on,
// and a strike is added to it times the object's gain. In addition every member keeps its own states, which are moved
// on in one jump when it is struck. When a member's gain or pan is about to move, its states are subtracted from the
// sum, and the object rings alone until the gain is constant again.
//
// A member that a listener hears from its place also has a gain for each mode, which is constant while it is a member:
// the direction from which a strike is heard is that at the strike. Placement::may_share() decides which objects stay
// within a decibel of this while they ring. [audio, after construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/output/channel_strip.h"
#include "engine/synth/objects/source.h"
#include "engine/synth/modes/voice.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ringdown::synth {

// An object's record of its membership.
struct GroupMember {
  bool shares_states = false;     // whether its states are in the group's sums; if not, nothing below counts
  ChannelStrip::Shares shares{};  // the object's gain at each output
  Frame anchor = 0;               // the frame that the object's own states have reached
  std::uint32_t struck_in = 0;    // the round of InstanceGroup in which the object was last struck
  std::uint32_t losses_seen = 0;  // the group's losses_ when the object's own states were last valid
};

class InstanceGroup final : public Source {
 public:
  // The table must outlive the group, or not be used any more. [worker]
  InstanceGroup(ModeTable& table, std::size_t ambisonic_channels);

  // Lets voices of the table join from now on.
  void found() REALTIME { table_.instances = this; }

  void render(const Chunk& chunk, Workspace& workspace) REALTIME override;
  void skip(const Chunk& chunk, Workspace& workspace) REALTIME override;
  [[nodiscard]] bool can_skip(const Chunk&) const REALTIME override { return true; }
  void prepare(const Chunk& chunk) REALTIME override { table_.prepare(chunk.frames); }
  void count_levels(const Chunk& chunk, LevelHistogram& histogram) REALTIME override;
  [[nodiscard]] ModeStates::Counts counts() const REALTIME override;

  // Returns whether an object at this bus may join: all members share one bus.
  [[nodiscard]] bool accepts(std::size_t bus) const REALTIME { return members_ == 0 || bus_ == bus; }
  // Takes over the object's states, which must have reached frame `now`. Returns true if they ring.
  [[nodiscard]] bool join(Object& object, Frame now) REALTIME;
  // Gives the object its states back at frame `now`.
  void leave(Object& object, Frame now) REALTIME;
  // Returns whether the member's own states are still its part of the sums.
  [[nodiscard]] bool keeps_states_of(const GroupMember& member) const REALTIME {
    return active && member.losses_seen == losses_;
  }

  [[nodiscard]] bool ringing() const REALTIME { return std::ranges::any_of(sums_, &ModeStates::ringing); }
  // Call when the group has fallen silent. No member counts as struck any more.
  void end_round() REALTIME;

 private:
  // Calls `each(sum, channel)` for the outputs that the group has.
  template <class Each>
  void for_outputs(const Each& each) REALTIME {
    each(sums_[0], kLeft);
    each(sums_[1], kRight);
    if (bus_ != kNoBus) each(sums_[2], bus_);
    for (std::size_t i = 3; i < sums_.size(); ++i) each(sums_[i], kFirstAmbisonic + i - 3);
  }
  void add(Voice& voice, const ChannelStrip::Shares& shares, double sign) REALTIME;
  [[nodiscard]] double floor(const Chunk& chunk) const REALTIME { return lowest_level_ * chunk.floor; }
  void catch_up(Object& object, Frame now) REALTIME;
  void note_struck(GroupMember& member) REALTIME;
  [[nodiscard]] bool strike(const DueEvent& struck, std::size_t frames_left, const Chunk& chunk) REALTIME;
  void render_by_moments(const Chunk& chunk, Workspace& workspace) REALTIME;
  void render_segment(std::size_t begin, std::size_t end, const Chunk& chunk, Workspace& workspace) REALTIME;
  void render_late(std::size_t begin, std::size_t end, const Chunk& chunk, Workspace& workspace) REALTIME;
  void keep_if(bool sane, const Chunk& chunk) REALTIME;
  void silence() REALTIME;

  ModeTable& table_;
  std::vector<ModeStates> sums_;  // left, right, bus, and the existing ambisonic channels
  std::size_t bus_ = kNoBus;      // channel of the third sum
  std::size_t members_ = 0;
  std::size_t struck_ = 0;    // members struck in this round
  std::uint32_t round_ = 1;   // increases when the group falls silent
  double lowest_level_ = 1;   // smallest distance gain among this round's members; scales the audibility floor
  std::uint32_t losses_ = 0;  // number of times that the sums had to be discarded
};

}  // namespace ringdown::synth
