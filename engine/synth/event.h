// An event: something that happens to one object at one sample frame.
//
// A strike from a game over OSC, from the embedded scene or from a score is the same Event. Small and trivially
// copyable, because it crosses threads through SpscRing by value. [any thread]
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/rotation.h"
#include "engine/base/vec3.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace ringdown::modal {
struct SurfaceRelief;  // surface_relief.h
}

namespace ringdown::synth {

using Frame = std::int64_t;  // sample frames since the mixer started
inline constexpr Frame kNever = std::numeric_limits<Frame>::max();
using ObjectNumber = std::uint32_t;  // the object's place in the mixer, as the daemon assigned it
inline constexpr ObjectNumber kNoObject = ~ObjectNumber{0};
inline constexpr ObjectNumber kMaxObjects = 1024;  // objects of a mixer, numbered from 0

enum class EventType : std::uint8_t {
  strike,         // point_m, impulse_ns, contact_time_s: rings the object at the nearest point of its surface
  strike_vertex,  // vertex, impulse_ns, contact_time_s: rings it at one sample point
  gain,           // value: linear gain, reached over `ramp_s`
  pan,            // value: -1 left ... +1 right, equal power
  clear,          // fades what rings to silence within `ramp_s`, or a few milliseconds if that is longer
  contact,        // point_m, contact: something slides or rolls on the object, or has stopped to
  ring,           // vertex, count, value: sets `count` modes going, from mode `vertex` up, each at amplitude `value`
  click,          // impulse_ns, contact_time_s: sets the object in motion as a whole, which is heard too
  pose,           // point_m, rotation: where the object's frame lies in the scene at this frame
  listener,       // point_m, rotation: where the listener's frame lies; `object` does not count
  listener_off,   // nobody listens from a place any more; `object` does not count
  touch,          // point_m, touch: a bow, a mallet or another object that feels the object move, from now on
  listener_air,   // value, ramp_s: temperature in degrees Celsius, relative humidity in percent, for sound on its way
};

// The profile of a surface, as a sliding body feels it: random heights. For two surfaces in contact, their sum.
struct Texture {
  double roughness_m = 2e-6;     // root mean square of its heights
  double correlation_m = 5e-5;   // longest wavelength of its roughness
  double spectral_slope = -2.4;  // power over spatial frequency falls as f^slope, <= 0
  double shortest_m = 0;         // shortest wavelength of its roughness; 0: a sixteenth of the longest

  // The octaves of wavelengths that the roughness has, from the longest down.
  static constexpr std::size_t kOctaves = 5, kMaxOctaves = 12;  // without a shortest wavelength, and at most
  [[nodiscard]] std::size_t octaves() const RINGDOWN_REALTIME {
    if (!(shortest_m > 0)) return kOctaves;
    const double count = 1 + std::round(std::log2(correlation_m / shortest_m));
    return static_cast<std::size_t>(std::clamp(count, 1.0, static_cast<double>(kMaxOctaves)));
  }
  friend bool operator==(const Texture&, const Texture&) = default;
};

// One of the two surfaces of a contact, where its heights are known, and how fast the contact travels over it.
struct Passing {
  const modal::SurfaceRelief* relief = nullptr;  // null: they are not. Whoever sends the event keeps it
  double speed_m_s = 0;
};

// A lasting contact at one moment. Force and speeds change gradually from one event to the next, and after the last
// event they stay as they are. The contact ends when the force is 0, or when no event has come for a while.
struct Contact {
  std::uint32_t number = 0;  // which of the object's contacts
  Vec3 force_n;              // on the object, its frame: normal and friction together
  double slip_m_s = 0;       // speed at which the two surfaces slide past each other
  double roll_m_s = 0;       // speed at which the point of contact travels over the object as they roll
  Texture texture;           // of both surfaces together, unless one has a profile
  std::array<Passing, 2> surfaces;
  double finish_width_m = 0, relief_width_m = 0;  // over which profiles and mesoscale relief are smoothed
};

// A two-way contact (engine/contact): what touches the object feels how the object's surface moves under it, sample by
// sample. Directions are unit vectors in the object's frame.
//
// A `rub` is a lasting contact of an event that also says, in its `contact`, what it is like one-way; profiles and
// speeds along them are taken from there. What it is made of (mass, stiffness, friction) stays as it was at first.
struct Touch {
  enum class Kind : std::uint8_t { bow, mallet, couple, rub } kind = Kind::bow;
  std::uint32_t number = 0;  // which bow, coupling or rub of the object; every mallet is a new one
  // bow: the hair moves that way; mallet: it flies that way; couple, rub: the object is pushed that way by the other.
  Vec3 direction;
  double speed_m_s = 0;  // bow, mallet
  Vec3 slide_m_s;        // rub: how fast the other slides over the object, along the surface
  // bow, rub: pressed so hard, 0 ends it; couple: the other's weight, 0: both are held
  double force_n = 0;
  double mass_kg = 0;      // mallet, rub; couple: the other's, where it rests on the object by its weight
  double friction = 0;     // coefficient of static friction: the bow's rosin
  double sliding = 0.375;  // the share of it that is left at high speed
  double width_m = 0;      // bow
  double stiffness = 0;    // mallet, couple, rub: Hertz's k [N / m^1.5]; 0 ends a coupling
  double bounce = 1;       // mallet, couple: speed after over speed before an impact, 0.01 to 1
  double gap_m = 0;        // couple: between the surfaces at rest; negative: pressed together so deep
  // couple; mallet, rub: an object whose own surface is the mallet's head, or what rubs, if any.
  ObjectNumber other = kNoObject;
  Vec3 other_point_m;    // in the other object's frame
  Vec3 other_direction;  // mallet: the way it is pushed, in its own frame; 0 0 0: against `direction`
  Rotation to_other;     // rub: turns the object's frame into the other's; couple: their axes are parallel
};

struct Event {
  Frame frame = 0;
  ObjectNumber object = 0;
  EventType type = EventType::strike;
  std::uint32_t vertex = 0;
  std::uint32_t count = 0;
  Vec3 point_m;               // object frame
  Vec3 impulse_ns;            // object frame [N s]
  double contact_time_s = 0;  // duration of the half-sine force pulse; 0 is an ideal impulse
  double value = 0;
  double ramp_s = 0;
  Contact contact;
  Rotation rotation;
  Touch touch;
};
static_assert(std::is_trivially_copyable_v<Event>);

constexpr bool is_strike(const Event& event) {
  return event.type == EventType::strike || event.type == EventType::strike_vertex;
}

// Whether the event does nothing but add to the states of modes.
constexpr bool excites(const Event& event) { return is_strike(event) || event.type == EventType::ring; }

// Whether what the event does is heard, rather than seen or set.
constexpr bool is_sound(const Event& event) {
  return excites(event) || event.type == EventType::click || event.type == EventType::contact ||
         event.type == EventType::touch || event.type == EventType::clear;
}

// Whether the event happens to the listener, and to no object.
constexpr bool is_of_listener(const Event& event) {
  return event.type == EventType::listener || event.type == EventType::listener_off ||
         event.type == EventType::listener_air;
}

// Whether the event says where something is: it takes effect as it is known, because one goes to a place ahead of time.
constexpr bool is_placing(const Event& event) { return event.type == EventType::pose || is_of_listener(event); }

}  // namespace ringdown::synth
