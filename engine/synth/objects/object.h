// An object that can be struck: its voices, its channel strip, and the forces that act on it.
//
// An object renders itself while it rings alone. While it shares its states it is a member of an InstanceGroup, which
// renders for it; its own states then rest at frame `member.anchor`. [audio, after construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/contact/exciters.h"
#include "engine/synth/objects/instance_group.h"
#include "engine/synth/listening/fan.h"
#include "engine/synth/listening/pickups.h"
#include "engine/synth/listening/placement.h"
#include "engine/synth/modes/touched_states.h"
#include "engine/synth/output/channel_strip.h"
#include "engine/synth/objects/source.h"
#include "engine/synth/modes/voice.h"

#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

// The largest gain, pan or force [N] that is accepted: a larger one, or not-a-number, would spoil the whole mix.
inline constexpr double kMaxEventValue = 1e6;

class Object final : public Source {
  friend class TouchGroup;

 public:
  explicit Object(ObjectNumber own_number) : number(own_number) { placement.spread_looks(own_number); }  // [worker]

  void render(const Chunk& chunk, Workspace& workspace) REALTIME override;
  void skip(const Chunk& chunk, Workspace& workspace) REALTIME override;
  void fetch(FetchStage stage, std::size_t frames) const REALTIME override;
  [[nodiscard]] bool can_skip(const Chunk& chunk) const REALTIME override { return !driven(chunk); }
  void prepare(const Chunk& chunk) REALTIME override;
  void count_levels(const Chunk& chunk, LevelHistogram& histogram) REALTIME override;
  [[nodiscard]] ModeStates::Counts counts() const REALTIME override;

  // Returns true if it may share its states from frame `now` on: it has one voice, no force acts, and its gains stand
  // still.
  [[nodiscard]] bool can_share(Frame now) const REALTIME;
  // Returns true if some of it still has to be rendered.
  [[nodiscard]] bool ringing() const REALTIME;

  // Work (work_cost.h) of an event on the object, whose verb has this place in Verbs, and of beginning or ending to
  // share states.
  [[nodiscard]] double units_of(std::size_t verb) const REALTIME;
  [[nodiscard]] double units_to_share() const REALTIME;

  // An upper bound of the object's samples at frame `now`, at its gain, for meters. Adds the number of modes that it
  // looked at to `looked_at`.
  [[nodiscard]] double peak_level(Frame now, std::size_t& looked_at) const REALTIME;
  // Writes the amplitudes of the current voice's modes; returns how many they are.
  std::size_t write_amplitudes(Frame now, ModeWatch::Slot& to) const REALTIME;

  const ObjectNumber number;
  bool touched = false;   // a TouchGroup renders it
  Frame left_group = -1;  // the chunk in which something else than strikes happens to it
  VoiceStack voices;
  Placement placement;
  // fetch() asks for these in one piece, with the end of `placement`, behind its track, and the beginning of `strip`:
  Fan fan;
  ExciterSlots exciters;
  PickupSlots pickups;
  GroupMember member;
  ChannelStrip strip;

 private:
  [[nodiscard]] bool driven(const Chunk& chunk) const REALTIME { return exciters.act(chunk.input_sounds); }
  [[nodiscard]] bool only_struck(const Chunk& chunk) const REALTIME;
  [[nodiscard]] double floor(const Chunk& chunk) const REALTIME;
  [[nodiscard]] bool play_next(const Chunk& chunk, Workspace& workspace) REALTIME;
  struct Play;
  void play(const Event& event, const Chunk& chunk) REALTIME;
  void apply_threshold(const Chunk& chunk, Workspace& workspace) REALTIME;
  void render_by_tables(const Chunk& chunk, Workspace& workspace) REALTIME;
  void render_by_moments(const Chunk& chunk, Workspace& workspace) REALTIME;
  [[nodiscard]] bool is_cleared() const REALTIME;
  void hear(std::size_t begin, std::size_t end, const Chunk& chunk) REALTIME;
  void end_fan(const Chunk& chunk) REALTIME;
  void render_segment(std::size_t begin, std::size_t end, const Chunk& chunk, Workspace& workspace) REALTIME;
  void render_late(const Chunk& chunk, Workspace& workspace) REALTIME;
  void drive(std::size_t begin, std::size_t end, const Chunk& chunk, Workspace& workspace) REALTIME;

  // In place of render() while a TouchGroup renders it (touch_group.h): begin, segments with events between, end.
  void begin_touched(const Chunk& chunk, Workspace& workspace) REALTIME;
  void render_touched(std::size_t begin, std::size_t end, const Chunk& chunk, Workspace& workspace,
                      const TouchForces& touch) REALTIME;
  void end_touched(const Chunk& chunk, Workspace& workspace) REALTIME;
};

}  // namespace ringdown::synth
