// Plays recovered contacts step by step, as the contact points that a simulation would have found. [one thread at a
// time]
#pragma once

#include "engine/scene/contact_point.h"
#include "engine/scene/foley/recovery.h"

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

namespace ringdown::scene {

class FoleyPlayback {
 public:
  explicit FoleyPlayback(Recovery recovery) : recovery_(std::move(recovery)) {}

  [[nodiscard]] const Recovery& recovery() const { return recovery_; }

  // Returns the contact points of the step from `now_s` on, valid until the next call. Times must not decrease.
  std::span<const ContactPoint> step(double now_s, double step_s);

  // Returns whether all contacts are over at this time.
  [[nodiscard]] bool over(double now_s) const;

 private:
  void play(const RecoveredBlow& blow, double now_s);
  void play(const RecoveredTouch& touch, double share, double step_s);

  Recovery recovery_;
  std::size_t next_step_ = 0, next_blow_ = 0, first_touch_ = 0;
  std::vector<ContactPoint> points_;
  std::deque<MotionPair> motions_;  // of the step's points, which keep their addresses
};

}  // namespace ringdown::scene
