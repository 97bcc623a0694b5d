// The verbs: everything that can be done to an object of the mixer or to its listener, one struct each.
//
// A verb is declared here once, with its fields and their defaults. All doors speak of it in the same words: its row in
// protocol/table.cpp gives each field a name, a unit, a range and a sentence, and from the row come OSC messages,
// scores, the C function, Python's method and the reference. Inside the mixer every place that handles events visits
// the verb, so a verb that nothing plays does not compile.
//
// Points, impulses, forces and directions are in the object's frame. All structs are trivially copyable, because they
// cross threads by value. [any thread]
#pragma once

#include "engine/base/one_of.h"
#include "engine/base/range.h"
#include "engine/base/realtime.h"
#include "engine/base/rotation.h"
#include "engine/base/vec3.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace ringdown::modal {
struct SurfaceRelief;  // surface_relief.h
}

namespace ringdown::synth {

using ObjectNumber = std::uint32_t;  // the object's place in the mixer, as the daemon assigned it
inline constexpr ObjectNumber kNoObject = ~ObjectNumber{0};
inline constexpr ObjectNumber kMaxObjects = 2048;  // objects of a mixer, numbered from 0

// Contact time of a strike that names none. An ideal impulse, 0 s, excites every mode up to 20 kHz alike and sounds
// brighter than any real mallet. The force of a real contact is about half a sine in time, whose spectrum falls off
// above 1/contact_time. Hertz's law for a ball that meets steel at 1 m/s (K. L. Johnson, Contact Mechanics,
// equation 11.24) gives 0.07 ms for steel of 10 mm radius, and for 15 mm 0.1 ms of hardwood (E = 11 GPa), 0.2 ms of
// hard plastic (3 GPa) and 0.7 ms of hard rubber (0.1 GPa). Ours is the plastic mallet.
inline constexpr double kDefaultContactTime_s = 0.0002;

// Amplitude, of full scale, at which modes ring when a message names none: -20 dB.
inline constexpr double kDefaultRingAmplitude = 0.1;

// The profile of a surface, as a sliding body feels it: random heights. For two surfaces in contact, their sum.
struct Texture {
  double roughness_m = 2e-6;     // root mean square of its heights
  double correlation_m = 5e-5;   // longest wavelength of its roughness
  double spectral_slope = -2.4;  // power over spatial frequency falls as f^slope, <= 0
  double shortest_m = 0;         // shortest wavelength of its roughness; 0: a sixteenth of the longest

  // The octaves of wavelengths that the roughness has, from the longest down.
  static constexpr std::size_t kOctaves = 5, kMaxOctaves = 12;  // without a shortest wavelength, and at most
  [[nodiscard]] std::size_t octaves() const REALTIME {
    if (!(shortest_m > 0)) return kOctaves;
    const double count = 1 + std::round(std::log2(correlation_m / shortest_m));
    return static_cast<std::size_t>(std::clamp(count, 1.0, static_cast<double>(kMaxOctaves)));
  }
  friend bool operator==(const Texture&, const Texture&) = default;
};

// One of the two surfaces of a contact, where its heights are known, and how fast the contact travels over it.
struct Passing {
  const modal::SurfaceRelief* relief = nullptr;  // null: they are not known. Whoever sends the event keeps it
  double speed_m_s = 0;
};

// A lasting contact at one moment. Force and speeds change gradually from one event to the next, and after the last
// event they stay as they are. The contact ends when the force is 0, or when no event has come for a while,
// unless it stays.
struct Contact {
  std::uint32_t number = 0;  // which of the object's contacts
  Vec3 force_n;              // on the object: normal force and friction together
  double slip_m_s = 0;       // speed at which the two surfaces slide past each other
  double roll_m_s = 0;       // speed at which the point of contact travels over the object as they roll
  Texture texture;           // of both surfaces together, unless one has a profile
  std::array<Passing, 2> surfaces;
  double finish_width_m = 0, relief_width_m = 0;  // over which profiles and mesoscale relief are smoothed
  bool stays = false;                             // true: it goes on without events until one ends it
};

// The effect of a verb, which decides when and by whom it is played.
enum class Effect : std::uint8_t {
  excites,  // adds to the states of modes, and does nothing else
  begins,   // begins or changes a force that lasts, which the stage accepts ahead of the chunk
  damps,    // lets what rings die away
  sets,     // sets how an object is heard
  places,   // says where an object is. It takes effect as soon as it is known, because one moves there ahead of time
  listens,  // concerns the listener and no object, and takes effect as soon as it is known
};

namespace verb {

// Rings the object at the point of its surface that is nearest to point_m.
struct Strike {
  static constexpr Effect kEffect = Effect::excites;
  Vec3 point_m, impulse_ns;
  double contact_time_s = kDefaultContactTime_s;  // duration of the half-sine force pulse
};

// Rings the object at one sample point of its bank.
struct StrikeVertex {
  static constexpr Effect kEffect = Effect::excites;
  std::uint32_t vertex = 0;
  Vec3 impulse_ns;
  double contact_time_s = kDefaultContactTime_s;
};

// Rings the air in the object by a blow of the flat hand on its mouth.
struct Slap {
  static constexpr Effect kEffect = Effect::excites;
  double impulse_ns = 0;  // on the air in the mouth
  double contact_time_s = 0.001;
};

// Sets modes going, each at the same amplitude. Modes count from the lowest frequency, from 0.
struct Ring {
  static constexpr Effect kEffect = Effect::excites;
  std::uint32_t first = 0, count = 1;
  double amplitude = kDefaultRingAmplitude;
};

// Sets one mode going by a motion that is known, as a piece has it from the body that it broke off. The mode's
// coordinate is q = velocity / omega sin(omega t + phase), in a shape whose mass is 1.
struct Impart {
  static constexpr Effect kEffect = Effect::excites;
  std::uint32_t mode = 0;  // counted from the lowest frequency, from 0
  double velocity = 0;     // [kg^1/2 m/s]
  double phase_rad = 0;    // 0: as a blow starts it; pi/2: from rest, displaced
};

// A blow sets the object in motion as a whole, which is heard, too. Its strikes are verbs of their own.
struct Click {
  static constexpr Effect kEffect = Effect::begins;
  Vec3 impulse_ns;
  double contact_time_s = kDefaultContactTime_s;
};

// Something slides or rolls on the object, or has stopped to.
struct Contact {
  static constexpr Effect kEffect = Effect::begins;
  Vec3 point_m;
  synth::Contact contact;
};

// Breath over the mouth of the object: noise that drives the air in it and does not feel how the air moves.
struct Blow {
  static constexpr Effect kEffect = Effect::begins;
  double pressure_pa = 0;  // root mean square in the mouth; 0 ends it
};

// A bow on the object, which feels how the surface moves.
struct Bow {
  static constexpr Effect kEffect = Effect::begins;
  Vec3 point_m;
  Vec3 direction;  // in which the hair moves, a unit vector
  double speed_m_s = 0;
  double force_n = 0;  // 0 lifts the bow
  double width_m = 0;
  double rosin = 0.8;        // coefficient of static friction
  std::uint32_t number = 0;  // which of the object's bows
};

// A mallet that flies at the object and feels how the surface moves. Every mallet is a new one.
struct Mallet {
  static constexpr Effect kEffect = Effect::begins;
  Vec3 point_m, velocity_m_s;
  double mass_kg = 0.02;
  double head = 1e7;    // Hertz's k [N / m^1.5]
  double bounce = 0.9;  // speed after over speed before a blow on a wall, 0.01 to 1
};

// Another object touches this one: each feels how the other moves. The axes of the two are taken as parallel.
struct Couple {
  static constexpr Effect kEffect = Effect::begins;
  Vec3 point_m;
  ObjectNumber other = kNoObject;
  Vec3 other_point_m;        // in the other object's frame
  Vec3 direction;            // in which the other pushes this object, a unit vector
  double weight_n = 0;       // with which the other rests on this object; 0: both are held
  double gap_m = 0;          // between the surfaces at rest; negative: pressed together so deep
  double stiffness = 1e8;    // Hertz's k [N / m^1.5]; 0 parts the two
  double friction = 0.3;     // coefficient of static friction
  double bounce = 0.6;       // speed after over speed before an impact, 0.01 to 1
  double mass_kg = 0;        // of the other, where it rests by its weight; 0: from the weight
  std::uint32_t number = 0;  // which of the object's couplings
};

// Sets the linear gain, reached over ramp_s.
struct Gain {
  static constexpr Effect kEffect = Effect::sets;
  double gain = 1, ramp_s = 0;
};

// Sets the pan, -1 left ... +1 right, at equal power.
struct Pan {
  static constexpr Effect kEffect = Effect::sets;
  double pan = 0;
};

// The motion of a place of the surface, as a contact microphone or a laser vibrometer measures it, becomes output
// `number` from this frame on. A pickup of this number that is elsewhere ends at this frame.
struct Pickup {
  static constexpr Effect kEffect = Effect::sets;
  Vec3 point_m;
  Vec3 direction;            // of the motion, a unit vector; 0 0 0 removes the pickup from the object
  std::uint32_t number = 1;  // 1 to kMaxPickups
  std::uint32_t motion = 1;  // 0: displacement, 1: velocity, 2: acceleration
  double gain = 1;           // sample over motion in m, m/s or m/s^2
};

// Turns a fan in the mouth of the object's tube, as a vibraphone has it: what sounds out of the tube grows softer and
// louder at this rate, from an open mouth at this frame on.
struct Fan {
  static constexpr Effect kEffect = Effect::sets;
  static constexpr Range kRate_hz{0, 20}, kDepth{0, 1};
  double rate_hz = 0;
  double depth = 0;  // 1: the fan closes the mouth; 0: there is none
};

// Fades what rings to silence within ramp_s, or a few milliseconds if that is longer, and ends every contact.
struct Clear {
  static constexpr Effect kEffect = Effect::damps;
  static constexpr bool kEndsContacts = true;
  double ramp_s = 0;
};

// Lets what rings die away by 60 dB in within_s, as a hand on a cymbal does. Contacts go on, and later strikes ring
// in full.
struct Choke {
  static constexpr Effect kEffect = Effect::damps;
  double within_s = 0.2;
};

// The pose of the object's frame in the scene at this frame.
struct Pose {
  static constexpr Effect kEffect = Effect::places;
  ringdown::Pose pose;
};

// The pose of the listener's frame: x to the front, y to the left, z up.
struct Listener {
  static constexpr Effect kEffect = Effect::listens;
  ringdown::Pose pose;
};

// Nobody listens from a place any more.
struct ListenerOff {
  static constexpr Effect kEffect = Effect::listens;
};

// The air between the objects and the listener.
struct ListenerAir {
  static constexpr Effect kEffect = Effect::listens;
  double temperature_c = 20, humidity_percent = 50;
};

// The two verbs below come from scenes only, which know more of a two-way contact than a message says. A score has
// them as as_public() says.

// A body of a scene hits an object and both feel it: a mallet whose head may be another object's surface.
struct Collision {
  static constexpr Effect kEffect = Effect::begins;
  Vec3 point_m;
  Vec3 direction;  // of the flight, a unit vector
  double speed_m_s = 0;
  double mass_kg = 0, stiffness = 0, bounce = 1;
  ObjectNumber other = kNoObject;  // the object whose surface is the head, if any
  Vec3 other_point_m;              // in the other object's frame
  Vec3 other_direction;            // in which the other is pushed, in its own frame
  Vec3 impulse_ns;                 // of the strike on the first object that stands in when there is no time, and
  double contact_time_s = 0;       // its duration

  [[nodiscard]] Mallet as_public() const { return {point_m, speed_m_s * direction, mass_kg, stiffness, bounce}; }
};

// A lasting contact whose surfaces feel each other. Mass, stiffness and friction stay as they were at first.
struct Rub {
  static constexpr Effect kEffect = Effect::begins;
  Vec3 point_m;
  synth::Contact contact;  // how it sounds one-way; profiles and the speeds along them are taken from here
  Vec3 direction;          // in which the other pushes this object, a unit vector
  Vec3 slide_m_s;          // velocity of the other along the surface
  double load_n = 0;       // 0 ends the contact
  double mass_kg = 0;
  double friction = 0;             // coefficient of static friction
  double sliding = 0.375;          // the share of the friction that is left at high speed
  double stiffness = 0;            // Hertz's k [N / m^1.5]
  ObjectNumber other = kNoObject;  // the object whose surface rubs, if any
  Vec3 other_point_m;              // in the other object's frame
  Rotation to_other;               // turns the object's frame into the other's

  [[nodiscard]] Contact as_public() const { return {point_m, contact}; }
};

}  // namespace verb

// The verbs that every door has, in the order of the reference.
using PublicVerbs =
    Types<verb::Strike, verb::StrikeVertex, verb::Gain, verb::Pan, verb::Fan, verb::Pickup, verb::Ring, verb::Impart,
          verb::Clear, verb::Choke, verb::Slap, verb::Blow, verb::Contact, verb::Bow, verb::Mallet, verb::Couple,
          verb::Click, verb::Pose, verb::Listener, verb::ListenerOff, verb::ListenerAir>;
using Verbs = Joined<PublicVerbs, Types<verb::Collision, verb::Rub>>;
using Verb = OneOf<Verbs>;

// True for verbs that end every contact of their object.
template <class One>
inline constexpr bool kEndsContacts = requires {
  One::kEndsContacts;
};

static_assert(Verbs::kTrivial);

}  // namespace ringdown::synth
