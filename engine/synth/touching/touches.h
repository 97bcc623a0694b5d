// The two-way contacts of the mixer, and which objects they bring together. [audio, after construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/touching/touch_group.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

namespace ringdown::synth {

class Touches {
 public:
  enum class Answer {
    taken,    // the event is for the object's group to play
    nothing,  // it ends what does not exist
    one_way,  // there is no place or time for it: a strike may stand in for a mallet
    refused,  // its numbers make no sense
  };
  // Makes room for a two-way contact of `object`, and of `other` for a coupling, unless it is there already. The
  // objects ring alone from now on. `tight`: there is no time for more contacts.
  [[nodiscard]] Answer accept(const Touch& how, Frame frame, Object& object, Object* other, bool tight) REALTIME;

  // After the events of a chunk have been accepted: ends contacts whose objects are gone, and sorts the others into
  // groups that share no object. Objects in a group are marked as touched.
  void regroup() REALTIME;
  // Returns true if there is any contact.
  [[nodiscard]] bool any() const REALTIME { return any_; }
  // The groups to render in this chunk.
  [[nodiscard]] std::span<TouchGroup* const> groups() REALTIME { return {active_.data(), active_count_}; }

  // The strike that stands in for a mallet of which nothing is felt.
  [[nodiscard]] static verb::Strike strike_of(const Touch& mallet, const Object& object) REALTIME;

 private:
  [[nodiscard]] static bool can_touch(const Object* object) REALTIME {
    const Voice* const voice = object ? object->voices.current() : nullptr;
    return voice && voice->table().columns() <= kMaxTouchColumns;
  }

  [[nodiscard]] bool touches(const Object& object) const REALTIME {
    return std::ranges::any_of(slots_,
                               [&](const TouchSlot& slot) REALTIME { return slot.used && slot.involves(object); });
  }

  std::array<TouchSlot, kMaxTouches> slots_;
  std::array<TouchGroup, kMaxTouches> groups_;  // that of its first slot
  std::array<TouchGroup*, kMaxTouches> active_{};
  std::size_t active_count_ = 0;
  bool any_ = false;
};

}  // namespace ringdown::synth
