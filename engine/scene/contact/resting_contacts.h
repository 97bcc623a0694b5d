// Resting contacts: contacts that last and do not move. They damp the objects whose bodies they touch.
//
// RestingContacts receives once a step every pair that touches without striking, and returns the bodies whose resting
// contacts have changed. A pair is judged over windows of kRestWindow_s, so that a trembling body does not flicker.
// Time in which both bodies sleep does not count: their resting contact is kept. Free of any physics engine. [one
// thread at a time]
//
//   RestingContacts resting(step_s);
//   resting.add(contact, points);                   // for each such pair, once
//   a step for (const BodyId id : resting.advance(moved)) resting.each_of(id,
//   [](const RestingContact& contact) { ... });
#pragma once

#include "engine/scene/contact/contact_life.h"

#include <optional>
#include <span>
#include <vector>

namespace ringdown::scene {

inline constexpr double kRestWindow_s = 0.05;

// A resting contact as it was when last reported. World axes.
struct RestingContact {
  struct Point {
    Vec3 point_m, normal;
  };
  BodyPair pair;
  double force_n = 0;  // normal force of all points together: the mean over a window
  std::vector<Point> points;
  Motion first, second;
};

class RestingContacts {
 public:
  explicit RestingContacts(double step_s);

  // Adds the contact of a pair in this step, and its points.
  void add(const PairContact& contact, std::span<const ContactPoint* const> points);

  // Ends a step in which the bodies `moved` moved. Returns the bodies with a resting contact that has begun, ended or
  // changed by more than a third; valid until the next call.
  std::span<const BodyId> advance(std::span<const MovedBody> moved);

  // Removes a body with its resting contacts. The next advance() returns the bodies it rested on.
  void remove(BodyId id);

  // Returns whether the next advance() will return a body even if none moves.
  [[nodiscard]] bool pending() const { return !changed_.empty(); }

  // Calls `each` with the resting contacts of a body.
  template <class Each>
  void each_of(BodyId id, const Each& each) const {
    for (const auto& [pair, life] : lives_) {
      if (life.reported && (pair.first == id || pair.second == id)) each(*life.reported);
    }
  }

 private:
  struct Life {
    int steps = 0;    // steps in this window
    int touched = 0;  // steps of this window with a contact
    double impulse_ns = 0;
    bool moves = false;    // whether the pair slides or rolls in this window
    bool touches = false;  // whether the pair touches in this step
    RestingContact latest;
    std::optional<RestingContact> reported;  // nothing: the pair does not rest
  };

  void judge(BodyPair pair, Life& life);
  void note_change(BodyPair pair);

  double step_s_;
  int window_;
  PairMap<Life> lives_;
  std::vector<BodyId> moved_, changed_, reported_;
};

}  // namespace ringdown::scene
