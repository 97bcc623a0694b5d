#include "engine/synth/objects/instance_group.h"

#include "engine/synth/modes/counters.h"
#include "engine/synth/objects/object.h"
#include "engine/synth/objects/shedding.h"
#include "engine/synth/modes/work_cost.h"

#include <algorithm>
#include <utility>

// A strike on one member
//
// A member's amplitudes are added twice: to the member's own states, which catch_up() first moves to the strike's frame
// in one jump, and, times the member's gain there, to the sums of the outputs. Only the sums are rendered, so a chunk
// costs one set of states for each output, however many members ring. leave() later subtracts the member's own states,
// moved on by the same poles, from the sums: both agree to rounding, so the subtraction is inaudible.
//
// A chunk is rendered like that of an object (object.cpp): with tables it is cut at strikes; with moments, strikes
// inside it are late strikes. An event for which there is no time stays on the list, with all later ones.
namespace ringdown::synth {

InstanceGroup::InstanceGroup(ModeTable& table, std::size_t ambisonic_channels) : table_(table) {
  for (std::size_t i = 0; i < 3 + ambisonic_channels; ++i) sums_.emplace_back(table);
}

// Adds, or with `sign` -1 subtracts, what rings in a member.
void InstanceGroup::add(Voice& voice, const ChannelStrip::Shares& shares, double sign) REALTIME {
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    if (shares[i] != 0) sums_[i].add(voice, sign * shares[i], voice.gains.frozen());
  }
}

bool InstanceGroup::join(Object& object, Frame now) REALTIME {
  Voice& voice = *object.voices.current();
  object.member.shares_states = true;
  voice.gains.freeze();
  object.strip.stand(now);
  object.member.shares = object.strip.shares();
  lowest_level_ = std::min(lowest_level_, object.strip.place_level());
  object.member.anchor = now;
  object.member.losses_seen = losses_;
  bus_ = object.strip.bus();
  ++members_;
  if (!voice.ringing()) return false;
  add(voice, object.member.shares, 1);
  voice.rest();
  note_struck(object.member);
  return true;
}

void InstanceGroup::leave(Object& object, Frame now) REALTIME {
  GroupMember& member = object.member;
  member.shares_states = false;
  catch_up(object, now);
  if (active) add(*object.voices.current(), member.shares, -1);
  if (std::exchange(member.struck_in, 0) == round_) --struck_;
  if (--members_ == 0) silence();
  object.voices.current()->wake();
}

// Moves the states that a member keeps for itself on to frame `now`.
void InstanceGroup::catch_up(Object& object, Frame now) REALTIME {
  GroupMember& member = object.member;
  if (std::exchange(member.losses_seen, losses_) != losses_) object.voices.current()->silence();
  object.voices.current()->skip(now - std::exchange(member.anchor, now));
}

void InstanceGroup::note_struck(GroupMember& member) REALTIME {
  if (std::exchange(member.struck_in, round_) != round_) ++struck_;
}

void InstanceGroup::end_round() REALTIME {
  struck_ = 0;
  lowest_level_ = 1;
  ++round_;
}

void InstanceGroup::render(const Chunk& chunk, Workspace& workspace) REALTIME {
  if (chunk.shedding->active()) {
    for_outputs([&](ModeStates& sum, std::size_t) REALTIME { chunk.shedding->apply(sum, 0, look_again, workspace); });
  }
  const auto may_play = [&]() REALTIME {
    return chunk.shedding->may_play(due.first->object->units_of(due.first->event.verb.index()), workspace);
  };
  for (; due.first && due.first->offset == 0 && may_play(); due.first = due.first->next) {
    static_cast<void>(strike(*due.first, 0, chunk));
  }
  if (chunk.moments) render_by_moments(chunk, workspace);
  std::size_t at = 0;
  bool struck_late = false;
  const auto render_to = [&](std::size_t end) REALTIME {
    if (!chunk.moments) render_segment(at, end, chunk, workspace);
    if (struck_late) render_late(at, end, chunk, workspace);
    at = end;
  };
  for (; due.first && may_play(); due.first = due.first->next) {
    render_to(due.first->offset);
    const bool struck = strike(*due.first, chunk.moments ? chunk.frames - at : 0, chunk);
    struck_late = struck_late || (struck && chunk.moments);
  }
  render_to(chunk.frames);
  for_outputs([&](ModeStates& sum, std::size_t) REALTIME {
    if (struck_late) sum.merge_late();
    const ModeStates::Counts counts = sum.counts();
    workspace.counts.add(counts);
    chunk.shedding->worked(render_units(counts.sounding, chunk.frames, chunk.moments), workspace);
  });
  workspace.counts.voices += static_cast<std::uint32_t>(struck_);
}

// Strikes a member: as a late strike `frames_left` frames before the end of the chunk, or at once if that is 0.
bool InstanceGroup::strike(const DueEvent& struck, std::size_t frames_left, const Chunk& chunk) REALTIME {
  Voice& voice = *struck.object->voices.current();
  GroupMember& member = struck.object->member;
  std::optional<double> energy;
  const auto find = [&]<class One>(const One& one) REALTIME {
    if constexpr (One::kEffect == Effect::excites) energy = voice.find_amplitudes(one);
  };
  visit_now(find, struck.event.verb);
  if (!energy || !(*energy <= kAbsurdEnergy)) {
    count(energy ? chunk.counters->not_finite : chunk.counters->refused);
    return false;
  }
  catch_up(*struck.object, struck.event.frame);
  voice.add(voice.amplitudes(), 1);
  voice.rest();
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    if (member.shares[i] == 0) continue;
    if (frames_left > 0) {
      sums_[i].add_late(voice.amplitudes(), member.shares[i], frames_left, voice.gains.frozen());
    } else {
      sums_[i].add(voice.amplitudes(), member.shares[i], voice.gains.frozen());
    }
  }
  note_struck(member);
  count(chunk.counters->strikes);
  return true;
}

void InstanceGroup::render_by_moments(const Chunk& chunk, Workspace& workspace) REALTIME {
  for_outputs([&](ModeStates& sum, std::size_t channel) REALTIME {
    if (!sum.ringing()) return;
    const bool wanted = contains(chunk.wanted, channel);
    const MomentTarget target{wanted ? workspace.sums.moments(channel) : nullptr, 1.0f};
    double* const rest = wanted && sum.needs_samples() ? workspace.sums.samples(channel) : workspace.mono.data();
    keep_if(sum.render_moments({&target, wanted ? std::size_t{1} : 0}, rest, chunk.frames, floor(chunk)), chunk);
  });
}

void InstanceGroup::render_segment(std::size_t begin, std::size_t end, const Chunk& chunk,
                                   Workspace& workspace) REALTIME {
  if (begin == end) return;
  for_outputs([&](ModeStates& sum, std::size_t channel) REALTIME {
    if (!sum.ringing()) return;
    double* const out = contains(chunk.wanted, channel) ? workspace.sums.samples(channel) : workspace.mono.data();
    keep_if(sum.render(out + begin, end - begin, floor(chunk)), chunk);
  });
}

void InstanceGroup::render_late(std::size_t begin, std::size_t end, const Chunk& chunk, Workspace& workspace) REALTIME {
  if (begin == end) return;
  for_outputs([&](ModeStates& sum, std::size_t channel) REALTIME {
    double* const out = contains(chunk.wanted, channel) ? workspace.sums.samples(channel) : workspace.mono.data();
    keep_if(sum.render_late(out + begin, end - begin), chunk);
  });
}

// A sum that was no longer sensible has been silenced: what its members keep for themselves goes too.
void InstanceGroup::keep_if(bool sane, const Chunk& chunk) REALTIME {
  if (sane) return;
  silence();
  ++losses_;
  count(chunk.counters->not_finite);
}

void InstanceGroup::silence() REALTIME {
  for (ModeStates& sum : sums_) sum.silence();
}

void InstanceGroup::skip(const Chunk& chunk, Workspace& workspace) REALTIME {
  for_outputs([&](ModeStates& sum, std::size_t) REALTIME {
    if (sum.ringing()) sum.mute_all(chunk.frames), workspace.counts.shed = true;
    workspace.counts.add(sum.counts());
  });
}

void InstanceGroup::count_levels(const Chunk& chunk, LevelHistogram& histogram) REALTIME {
  for_outputs([&](ModeStates& sum, std::size_t) REALTIME { sum.count_levels(histogram, 0, floor(chunk)); });
}

ModeStates::Counts InstanceGroup::counts() const REALTIME {
  ModeStates::Counts all;
  for (const ModeStates& sum : sums_) all.add(sum.counts());
  return all;
}

}  // namespace ringdown::synth
