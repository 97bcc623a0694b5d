// A scene in motion: bodies fall and collide, and their contacts become events for the mixer.
//
// A World knows nothing of threads, clocks or sockets. Its owner steps it: a daemon paced by its clock, a renderer as
// fast as it can. The same description, objects and calls give the same events, bit for bit, on one machine.
//
//   Result<World> world = World::create(scene, objects, 48000);
//   world->set_start_frame(now);  // the frame of the scene's time 0
//   for (;;) {
//     const StepReport report = world->step();  // advances by step_s()
//     for (const synth::Event& event : report.events) play(event);  // in a mixer, or as OSC in another program
//   }
//
// Sound comes from contacts, by the rules of contact_life.h: two bodies that approach faster than the bounce threshold
// strike each other; a contact that lasts is reported while it slides or rolls, and silent while it rests. Both bodies
// sound, with opposite forces, each at the contact point in its own object's frame. A strike's impulse is the force of
// the contact joint times the step, normal force and friction together. Its contact time is given by the surfaces or
// follows from Hertz's law. [one thread at a time per World; several Worlds may run on several threads]
#pragma once

#include "engine/base/result.h"
#include "engine/scene/body_store.h"
#include "engine/scene/contact/heard_contact.h"
#include "engine/scene/contact/rest_damping.h"
#include "engine/scene/description.h"
#include "engine/scene/outline.h"
#include "engine/synth/events/event.h"

#include <atomic>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace ringdown::scene {

// Longer steps are divided into equal parts of at most this length, so that towers stand and bounces are accurate for
// any step. The step itself is only the interval at which a World reports.
inline constexpr double kMaxPart_s = 1.0 / 480;

inline constexpr int kMaxResets = 3;  // a body that has to be reset more often is removed

// Views into the World, valid until its next step().
struct StepReport {
  std::span<const synth::Event> events;         // strikes, clicks, lasting contacts; their frames never decrease
  std::span<const RestDamping> rest_dampings;   // objects whose resting contacts have changed
  std::span<const HeardContact> contacts;       // for reports: blows, and the states of lasting contacts
  std::span<const std::string> notices;         // sentences for the user: a body was reset, removed, ...
  std::span<const synth::ObjectNumber> broken;  // objects whose bodies have become pieces
  std::size_t dropped_events = 0;               // beyond kMaxEventsPerStep in one part of the step
  std::size_t dropped_contacts = 0;             // beyond kMaxContactsPerStep in one part of the step
};

// A body for a viewer or a test. Position and rotation are those of the object's frame, in which the bank's mesh lies.
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
  bool waiting = false;  // waits for its start_s and is not in the scene yet
};

class World {
 public:
  // Builds the scene. `objects` must hold every object that its bodies name, and may hold more for bodies spawned
  // later. Fails on a value outside its range, a bank without mass or surface, or an unknown name.
  static Result<World> create(const SceneDescription& scene, std::span<const SoundingObject> objects,
                              double sample_rate_hz);
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  ~World();

  // Sets the frame of scene time 0, so that an owner who pauses can shift all later events. 0 by default.
  void set_start_frame(synth::Frame frame);

  // Sets the rate of frames from the next step on. The owner has to set the start frame again.
  void set_sample_rate(double sample_rate_hz);

  // Lets the random order of the contact solver depend on the number of the step alone, so that foley/guide.h can
  // simulate a part of a recorded scene as the whole was simulated.
  void number_steps();

  // Advances by one step. A strike's frame is that of its impact, within this step or the one before; reports of
  // lasting contacts have the frame of the beginning of the step. Never fails: a body whose motion has become unreal
  // (not a number, too fast) goes back to its start at rest, a body that has left the scene is removed, and a notice
  // says so. While all bodies sleep a step costs nothing. Once `*given_up` is not 0 the step stops looking for contacts
  // and ends soon; for an owner who is about to clear the world.
  StepReport step(const std::atomic<int>* given_up = nullptr);

  // Returns whether any body plays an object. If none does, steps make no events, except those that end lasting
  // contacts.
  [[nodiscard]] bool sounds() const;

  // Returns whether a lasting contact has not been reported as ended yet. After all bodies are gone, a few more steps
  // report all ends.
  [[nodiscard]] bool has_lasting_contacts() const;

  [[nodiscard]] double time_s() const;  // step_s() times the steps so far
  [[nodiscard]] double step_s() const;

  // Adds a body, whose number is appended to its name and never used again. Fails when the scene is full, a value is
  // out of range, or the object is unknown.
  Result<BodyId> spawn(BodyDescription body);

  // Takes a body out of the scene, with its joints. restore() puts it back under its number: where it was, at rest, and
  // joined as before once the other bodies of its joints are there. remove() fails if there is no such body, restore()
  // if the body was not removed.
  Result<void> remove(BodyId id);
  Result<void> restore(BodyId id);
  // Puts a body elsewhere, at rest: `pose` is that of the object's frame. A body that waits for its start begins there.
  // Fails if there is no such body, or if a joint or a path determines where it is.
  Result<void> place(BodyId id, const Pose& pose);
  void clear_spawned();  // removes only bodies that spawn() added, and pieces of broken bodies
  void clear();          // removes every body; statics stay

  // Adds an object, or replaces the bank of the object with this name: its bodies take the new mass and shape in place.
  // Fails, and changes nothing, if one of the bodies cannot be built.
  Result<void> set_object(const SoundingObject& object);

  // Removes an object. Its bodies stay and become silent.
  void remove_object(synth::ObjectNumber number);

  // Gives a body an impulse [N s, world axes] at its centre of mass.
  Result<void> push(BodyId id, Vec3 impulse_ns);

  [[nodiscard]] std::vector<BodyState> bodies() const;  // in order of number: described bodies first, then spawned ones

  // The appearance of all bodies, in the order of bodies(). The result changes with spawn(), clear(), set_object(),
  // remove_object(), and when a step removes a body.
  [[nodiscard]] std::vector<BodyOutline> describe() const;

 private:
  struct State;
  explicit World(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ringdown::scene
