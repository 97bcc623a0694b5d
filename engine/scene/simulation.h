// Rigid bodies that collide: everything Ringdown asks of ODE, and nothing of sound.
//
// World (world.h) turns what touches into what is heard. This layer takes input that is already checked: ODE ends
// the process on a NaN or a mass of zero, so whoever calls must have gone through solid.h and the ranges of
// description.h. ODE's collision code keeps state of the whole process: every call here takes one process-wide lock,
// so simulations on several threads wait for each other but are safe. [one thread at a time per Simulation]
#pragma once

#include "engine/scene/contact_rules.h"
#include "engine/scene/description.h"
#include "engine/scene/solid.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace ringdown::scene {

// A body's number, never used twice in one simulation; statics count from kFirstStatic.
using BodyId = std::uint32_t;
inline constexpr BodyId kFirstStatic = 1u << 31;

inline constexpr std::size_t kMaxContactsPerPair = 4;  // the deepest, and those farthest from each other
inline constexpr std::size_t kMaxContactsPerStep = 4096;

// With more contact points among bodies that touch each other an iterative solver takes over, for all. At a step of 2
// ms; grows with the cube root of the step.
inline constexpr double kMaxExactContacts = 52;

// A step is cut into at most this many parts, so that nothing flies through what it should hit.
inline constexpr int kMaxParts = 16;

// Where a body is and how it moves. World axes; the position is that of the centre of mass.
struct Motion {
  Vec3 position_m;
  Rotation rotation;  // object frame -> world
  Vec3 velocity_m_s;
  Vec3 spin_rad_s;

  [[nodiscard]] Vec3 velocity_at(Vec3 world_m) const { return velocity_m_s + cross(spin_rad_s, world_m - position_m); }
};

// One contact point of one step.
struct Touch {
  BodyId body = 0, other = 0;  // `body` can move; `other` may be a static
  Vec3 point_m;                // world
  Vec3 normal;                 // unit, into `body`
  double depth_m = 0;          // how far the two had come into each other
  Vec3 impulse_ns;             // what `body` received in this step, world axes; `other` received the opposite
  double approach_m_s = 0;     // speed at which the two came together just before, along the normal
  double found_s = 0;          // when, from the beginning of the step
  Motion of_body, of_other;    // at that time; a static stays at the origin
};

struct Moved {
  BodyId id = 0;
  Motion motion;
};

class Simulation {
 public:
  // Gravity, step and contact settings of the description; not its bodies and statics.
  explicit Simulation(const SceneDescription& scene);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  void add_static(BodyId id, const StaticDescription& description);

  // Adds the body, or replaces it; its joints then stay. A fixed body ignores velocity, gravity and contacts.
  void put_body(BodyId id, const Solid& solid, const Motion& motion, const Surface& surface, bool fixed);
  void remove_body(BodyId id);  // its joints go too

  // Joins two bodies, or one and the world, as they are now. Its names are not looked at.
  void add_joint(BodyId body, std::optional<BodyId> other, const JointDescription& description);

  void set_motion(BodyId id, const Motion& motion);  // wakes the body

  // Advances by one step of the description's length. The contacts stay valid until the next call of anything here.
  // A body about to fly through another, or deep into it, is stopped where they meet: the step is then done in parts.
  std::span<const Touch> step();

  // Where the bodies are that the last step moved. Those that sleep are not among them.
  [[nodiscard]] std::span<const Moved> moved() const;

  // Nothing moves, and nothing will by itself: a step would change nothing.
  [[nodiscard]] bool asleep() const;

  // Contact points beyond kMaxContactsPerStep, left out of the last step: their bodies sink in until others part.
  [[nodiscard]] std::size_t dropped_contacts() const;

 private:
  struct Ode;
  std::unique_ptr<Ode> ode_;
};

}  // namespace ringdown::scene
