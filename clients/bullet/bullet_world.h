// Plays a scene in another physics engine: its bodies move in Bullet, and their contacts become Ringdown's events.
//
// To connect your own engine, replace what bullet_world.cpp does with Bullet: provide one list of contact points per
// step, with the position, normal and depth of each point, the motion of both bodies just before the contact was
// solved, and the impulse that it then received. scene::ContactSounds turns that list into events: it decides which
// contacts strike, which last, and how long an impact takes. Mass, inertia and shape come from the bank
// (engine/scene/solid.h). [one thread at a time]
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"
#include "engine/scene/contact/contact_sounds.h"
#include "engine/scene/description.h"
#include "engine/synth/events/event.h"

#include <memory>
#include <span>

namespace ringdown::bullet {

inline constexpr double kFrameRate_hz = 1e6;  // frames of events are microseconds of scene time

class BulletWorld {
 public:
  // `banks` holds the bank of each object of the scene, in order; an event's object number is the index there. Fails
  // like World::create() (engine/scene/world.h), and on joints, emitters, scatter and trimesh bodies, which are not
  // supported here. Fast bodies may pass through thin ones.
  static Result<BulletWorld> create(const scene::SceneDescription& scene,
                                    std::span<const std::shared_ptr<const modal::Bank>> banks);
  BulletWorld(BulletWorld&&) noexcept;
  ~BulletWorld();

  // The events of a step: strikes, reports of lasting contacts, and objects whose resting contacts have changed. Frames
  // never decrease and lie at most two steps before the step's end. Valid until the next call.
  struct StepEvents {
    std::span<const synth::Event> events;
    std::span<const scene::RestDamping> dampings;
  };

  // Advances by the scene's step_s and returns the step's events.
  StepEvents step();

  [[nodiscard]] double time_s() const;

 private:
  struct Impl;
  explicit BulletWorld(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace ringdown::bullet
