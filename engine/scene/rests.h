// What rests on what: contacts that last and do not move, which damp the bodies they touch.
//
// Fed once a step with every pair that touches without a blow, it answers whose rests have changed. A pair is looked at
// over windows of kRestWindow_s, so that what trembles does not flicker; the time in which both bodies sleep does not
// count, and what they rest on stays. Free of any physics engine. [any thread]
//
//   Rests rests(step_s);
//   rests.touch(touching, touches);           // for a pair whose touch is no blow, once a step
//   for (const BodyId id : rests.advance(moved)) rests.each_of(id, [](const Rest& rest) { ... });
#pragma once

#include "engine/scene/contact_life.h"

#include <map>
#include <optional>
#include <span>
#include <vector>

namespace ringdown::scene {

inline constexpr double kRestWindow_s = 0.05;

// World axes, at the time when it was last found to differ.
struct Rest {
  struct Point {
    Vec3 point_m, normal;
  };
  BodyPair pair;
  double force_n = 0;  // at all points together, along their normals: the mean of a window
  std::vector<Point> points;
  Motion first, second;
};

class Rests {
 public:
  explicit Rests(double step_s);

  void touch(const Touching& all, std::span<const Touch* const> touches);

  // Ends a step in which these bodies moved. The bodies whose rests have begun, ended or changed by more than a third,
  // valid until the next call.
  std::span<const BodyId> advance(std::span<const Moved> moved);

  // A body has gone, and its rests with it; the next advance() names those it rested on.
  void remove(BodyId id);

  // Whether the next advance() names a body even if nothing moves.
  [[nodiscard]] bool pending() const { return !changed_.empty(); }

  template <class Each>
  void each_of(BodyId id, const Each& each) const {
    for (const auto& [pair, life] : lives_) {
      if (life.told && (pair.first == id || pair.second == id)) each(*life.told);
    }
  }

 private:
  struct Life {
    int steps = 0, touched = 0;  // of this window
    double impulse_ns = 0;
    bool moves = false, touches = false;
    Rest latest;
    std::optional<Rest> told;
  };

  void look(BodyPair pair, Life& life);
  void note(BodyPair pair);

  double step_s_;
  int window_;
  std::map<BodyPair, Life> lives_;
  std::vector<BodyId> moved_, changed_, reported_;
};

}  // namespace ringdown::scene
