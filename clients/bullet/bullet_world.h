// Ringdown played by another physics engine: a scene's bodies move in Bullet, and their contacts become events.
//
// To connect an engine of your own, replace what bullet_world.cpp does with Bullet. It comes down to one list per step:
// of every point where two bodies touch, where it is, its normal and depth, how both bodies moved just before the
// contact was solved, and the impulse it then passed. scene::Sounding makes of it what is heard: which contacts strike,
// which last, and for how long a blow presses. Mass, inertia and shape come from the bank (engine/scene/solid.h).
// [one thread at a time]
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"
#include "engine/scene/description.h"
#include "engine/scene/sounding.h"
#include "engine/synth/event.h"

#include <memory>
#include <span>

namespace ringdown::bullet {

inline constexpr double kFrameRate_hz = 1e6;  // an event's frame is a microsecond of the scene's time

class BulletWorld {
 public:
  // `banks` holds one for each object of the scene, in its order; an event's object is its place there. Refuses with a
  // sentence what World::create() (engine/scene/world.h) refuses, and what Bullet does not do here: joints, emitters,
  // scatter, trimesh bodies. What flies fast may pass through what is thin.
  static Result<BulletWorld> create(const scene::SceneDescription& scene,
                                    std::span<const std::shared_ptr<const modal::Bank>> banks);
  BulletWorld(BulletWorld&&) noexcept;
  ~BulletWorld();

  // What is heard of a step: strikes, tellings of lasting contacts, and what rests on objects. Frames never fall,
  // within and between steps, and lie at most two steps before the step's end. Valid until the next call.
  struct Heard {
    std::span<const synth::Event> events;
    std::span<const scene::Leaning> leanings;
  };

  // Advances by the scene's step_s.
  Heard step();

  [[nodiscard]] double time_s() const;

 private:
  struct Impl;
  explicit BulletWorld(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace ringdown::bullet
