// Rigid bodies that collide: all uses of ODE, and nothing about sound. World (world.h) passes the contact points on to
// ContactSounds (contact_sounds.h), which turns them into events.
//
// Input must be checked beforehand, by solid.h and the ranges of description.h: ODE ends the process on a NaN or a mass
// of zero. Every call takes one process-wide lock, because ODE's collision code keeps global state; simulations on
// several threads are safe but wait for each other. [one thread at a time per Simulation]
#pragma once

#include "engine/scene/contact/contact_rules.h"
#include "engine/scene/contact_point.h"
#include "engine/scene/description.h"
#include "engine/scene/solid.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace ringdown::scene {

// Maximum number of contact points in one island of bodies for ODE's exact solver; with more, the iterative solver
// takes over for all bodies. The number applies at a step of 2 ms and grows with the cube root of the step.
inline constexpr double kMaxExactContacts = 52;

// Maximum number of parts into which a step is divided, so that fast bodies do not fly through obstacles.
inline constexpr int kMaxParts = 16;

// The state of a simulation between two steps.
struct SimulationMemory;

class Simulation {
 public:
  // Takes gravity, step and contact settings from the description, but not its bodies, statics and joints.
  explicit Simulation(const SceneDescription& scene);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  void add_static(BodyId id, const StaticDescription& description);

  // Adds a body, or replaces one but keeps its joints. A fixed body ignores velocity, gravity and contacts.
  // `gravity_factor` scales the scene's gravity.
  void put_body(BodyId id, const Solid& solid, const Motion& motion, const FrictionSurface& surface, bool fixed,
                double gravity_factor = 1);
  void set_filter(BodyId id, const CollisionFilter& filter);  // for a body or a static; holds until it is removed

  // Keeps the pieces of a broken body, which are hulls, from touching each other until they have been apart. `whole` is
  // the body, if it is still there.
  void keep_from_touching(std::span<const BodyId> pieces, std::optional<BodyId> whole = {});
  void remove_body(BodyId id);  // also removes its joints

  // Joins two bodies in their present poses, or one body to the world. The names in the description are ignored.
  void add_joint(BodyId body, std::optional<BodyId> other, const JointDescription& description);

  void set_motion(BodyId id, const Motion& motion);  // wakes the body
  void place(BodyId id, const Motion& motion);  // puts a body elsewhere, and wakes all: what rested on it must fall

  // Places a body, which sleeps there until something touches it.
  void rest(BodyId id, const Motion& motion);

  // memory() and recall() serve a caller that simulates the same time several times over: recall() brings back all
  // bodies that can move as they were when memory() was called. Bodies that came later stay where they are.
  [[nodiscard]] std::shared_ptr<const SimulationMemory> memory() const;
  void recall(const SimulationMemory& memory);

  // Sets the motion of a body that goes on: the body keeps what it owes, and how long it has been still.
  void correct(BodyId id, const Motion& motion);

  // Lets the random order in which the iterative solver visits contacts depend on the number of the next step, instead
  // of on how often it has solved. A step with the same number then gives the same motion, whatever was simulated
  // before.
  void number_step(std::uint64_t number);

  // Sets the motion of a fixed body in the next step, at a constant velocity. Wakes all bodies if the body does move.
  void drive(BodyId id, const Motion& motion);

  // Advances by one step and returns its contact points, which stay valid until the next call. If a body is about to
  // fly through another, or deep into it, the step is done in parts, one of which ends where the two meet. Once
  // `*given_up` is not 0, no more contacts are searched, and bodies pass through each other.
  std::span<const ContactPoint> step(const std::atomic<int>* given_up = nullptr);

  // The bodies that the last step moved. Sleeping bodies are not among them.
  [[nodiscard]] std::span<const MovedBody> moved() const;

  // Returns whether all bodies sleep, so that a step would change nothing.
  [[nodiscard]] bool asleep() const;

  // Returns how many contact points and whole pairs of bodies the last step ignored because they were beyond
  // kMaxContactsPerStep. Such bodies sink into each other until other contacts end.
  [[nodiscard]] std::size_t dropped_contacts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ringdown::scene
