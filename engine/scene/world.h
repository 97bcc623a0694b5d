// A scene in motion: bodies fall, collide, and what their contacts sound like comes out as events.
//
// A World knows nothing of threads, clocks or sockets. Its owner steps it: a daemon paced by its clock, a renderer as
// fast as it can. The same description, objects and calls give the same events, bit for bit, on one machine.
//
//   Result<World> world = World::create(scene, objects, 48000);
//   world->set_start_frame(now);                       // where scene time 0 lies
//   for (;;) {
//     const StepReport report = world->step();         // advances by step_s()
//     for (const synth::Event& event : report.events) ...  // to a mixer, or as OSC to another program
//   }
//
// What sounds: contacts, by the rules of contact_life.h. One whose two bodies approached faster than the bounce
// threshold strikes; one that lasts is told of while it slides or rolls, and is silent while it rests. Both bodies
// ring, with opposite forces, each at the contact's point in its own object's frame. A strike's impulse is the contact
// joint's force times the step: normal and friction together; its contact time is the surface's, or follows from
// Hertz's law. [one thread at a time per World; several Worlds may run on several threads]
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"
#include "engine/scene/description.h"
#include "engine/scene/outline.h"
#include "engine/scene/simulation.h"
#include "engine/scene/sounding.h"
#include "engine/synth/event.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace ringdown::scene {

// A longer step is done in equal parts no longer than this, as if the scene had that step: towers then stand and
// bounces come out right at every step. A step is only how often a World reports.
inline constexpr double kMaxPart_s = 1.0 / 480;

inline constexpr int kMaxResets = 3;  // a body that has to be reset more often is removed

// An object as the mixer knows it: what a body named after it rings.
struct SoundingObject {
  std::string name;
  synth::ObjectNumber number = 0;
  std::shared_ptr<const modal::Bank> bank;  // as baked: the World applies the description's density scale
};

// Views into the World, valid until its next step().
struct StepReport {
  std::span<const synth::Event> events;  // strikes, clicks, contacts that last; frames never fall, between steps too
  std::span<const Leaning> leanings;     // objects on which something else lies than before
  std::span<const std::string> notices;  // sentences for the user: a body was reset, removed, ...
  std::size_t dropped_events = 0;        // beyond kMaxEventsPerStep in one part of the step
  std::size_t dropped_contacts = 0;      // beyond kMaxContactsPerStep in one part of it
};

// A body for a viewer or a test. The pose is that of the object's frame: a bank's mesh drawn with it is in place.
struct BodyState {
  BodyId id = 0;
  std::string name;
  std::string object;  // empty: silent
  Vec3 position_m;
  Rotation rotation;
  Vec3 center_m;      // centre of mass
  Vec3 velocity_m_s;  // of the centre of mass
  Vec3 spin_rad_s;
  bool fixed = false;
  bool waiting = false;  // for its start_s: not in the scene yet
};

class World {
 public:
  // Builds the scene. Every object that its bodies name must be among `objects`; more may be given, for spawning.
  // Refused with one sentence: anything outside its range, a bank without mass or surface, a name that is missing.
  static Result<World> create(const SceneDescription& scene, std::span<const SoundingObject> objects,
                              double sample_rate_hz);
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  ~World();

  // The frame at which scene time 0 lies, so that an owner who pauses can shift what follows. Initially 0.
  void set_start_frame(synth::Frame frame);

  // What frames are counted by from the next step on. The owner sets the start frame anew.
  void set_sample_rate(double sample_rate_hz);

  // Advances by one step and reports what sounded: strikes at the frame of their time of touch, which lies in the time
  // of this step or of the one before; contacts that last at the frame of the step's beginning. Never fails: a body
  // that has become unreal (not a number, too fast) goes back to its start at rest, one that has left the scene is
  // removed, and a notice says so. While all bodies sleep a step costs nothing.
  StepReport step();

  // Whether a body is there, or to come, that sounds: without one no step makes an event, but for contacts to be ended.
  [[nodiscard]] bool sounds() const;

  // Whether a contact that lasts has been told of and not its end. Without bodies the next few steps end all.
  [[nodiscard]] bool telling() const;

  [[nodiscard]] double time_s() const;  // step_s() times the steps so far
  [[nodiscard]] double step_s() const;

  // Drops a new body, whose number is appended to its name and never used again. Refused when the scene is full, a
  // value is out of range or the World does not know its object.
  Result<BodyId> spawn(BodyDescription body);
  void clear_spawned();  // only what spawn() added
  void clear();          // every body; statics stay

  // A new object, or a new bank for one the World knows by this name: its bodies take the new mass and shape where
  // they are. Refused, and nothing changed, when a body of it could not be built.
  Result<void> set_object(const SoundingObject& object);

  // Its bodies stay and become silent.
  void remove_object(synth::ObjectNumber number);

  // Gives a body an impulse [N s, world axes] at its centre of mass.
  Result<void> push(BodyId body, Vec3 impulse_ns);

  [[nodiscard]] std::vector<BodyState> bodies() const;  // by number: the scene's own in its order, then spawned

  // What these look like, in the same order. It changes by spawn(), clear(), set_object() and remove_object(), and when
  // a step removes a body.
  [[nodiscard]] std::vector<BodyOutline> describe() const;

 private:
  struct Impl;
  explicit World(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace ringdown::scene
