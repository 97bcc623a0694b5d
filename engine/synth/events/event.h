// An event: a verb that happens to one object, or to the listener, at one sample frame.
//
// A strike from a game over OSC, from the embedded scene or from a score is the same Event. [any thread]
#pragma once

#include "engine/base/one_of.h"
#include "engine/base/realtime.h"
#include "engine/synth/events/verbs.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace ringdown::synth {

using Frame = std::int64_t;  // sample frames since the mixer started
inline constexpr Frame kNever = std::numeric_limits<Frame>::max();

struct Event {
  Frame frame = 0;
  ObjectNumber object = 0;  // not used by verbs of the listener
  Verb verb = verb::Strike();
};
static_assert(std::is_trivially_copyable_v<Event>);

namespace detail {

template <class... Ones>
constexpr std::array<Effect, sizeof...(Ones)> effects_of(Types<Ones...>) {
  return {Ones::kEffect...};
}
inline constexpr auto kEffects = effects_of(Verbs());

}  // namespace detail

// The effect of the verb with this place in Verbs.
constexpr Effect effect_of(std::size_t index) REALTIME { return detail::kEffects[index]; }
inline Effect effect_of(const Event& event) REALTIME { return effect_of(event.verb.index()); }

// Returns true if the event only adds to the states of modes.
inline bool excites(const Event& event) REALTIME { return effect_of(event) == Effect::excites; }

// Returns true if a verb of this effect is heard, false if it only sets something.
constexpr bool is_sound(Effect effect) REALTIME {
  return effect == Effect::excites || effect == Effect::begins || effect == Effect::damps;
}

// Returns true if a verb of this effect acts as soon as it is received, before its frame.
constexpr bool is_placing(Effect effect) REALTIME { return effect == Effect::places || effect == Effect::listens; }

// Returns true if the event concerns the listener and no object.
inline bool is_of_listener(const Event& event) REALTIME { return effect_of(event) == Effect::listens; }

}  // namespace ringdown::synth
