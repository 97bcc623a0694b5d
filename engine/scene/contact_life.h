// The life of a contact between two bodies: it begins with a strike, persists while they slide, roll or rest, and ends.
//
// Fed once a step with every pair that touches, it answers which of them strike, and what a contact that lasts is like.
// A pair that parts and touches again within the minimum repeat time goes on with the same contact: chatter is one
// contact, not a row of strikes. Free of any physics engine. [any thread]
//
//   ContactLives lives(minimum_repeat_s, step_s);
//   lives.strikes(pair, approach_m_s, now_s);        // for a pair that comes together fast: does it strike?
//   lives.touch(touching, now_s);                    // for a pair whose touch is no blow, once a step
//   for (const Telling& t : lives.advance(now_s)) ...
#pragma once

#include "engine/scene/simulation.h"

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace ringdown::scene {

// How often a contact that lasts is told of, unless the step is longer.
inline constexpr double kTellEvery_s = 0.004;

// A contact that slides and rolls more slowly than this rests, and is silent. One that is heard goes on down to half of
// it, so that it does not flicker.
inline constexpr double kMinContactSpeed_m_s = 0.01;

using BodyPair = std::pair<BodyId, BodyId>;  // the smaller number first

// What one pair does in one step, all its points together. World axes.
struct Touching {
  BodyPair pair;
  Vec3 point_m;              // of the contact points, weighted by their force
  Vec3 impulse_ns;           // on the first body
  double slip_m_s = 0;       // speed of the two surfaces past each other
  double most_roll_m_s = 0;  // the contact cannot travel faster than this: turning times the distance to a centre
  Motion first, second;      // a static stays at the origin
};

// What a contact was like since it was told of last.
struct Telling {
  BodyPair pair;
  bool begins = false;  // was not told of before
  bool ends = false;    // is over, or rests; the rest is without meaning
  Vec3 point_m;         // world
  Vec3 force_n;         // on the first body, world: the mean
  double slip_m_s = 0;  // mean, weighted by force
  double roll_m_s = 0;  // speed at which the point of contact travels over both surfaces at once
  Motion first, second;
};

class ContactLives {
 public:
  ContactLives(double minimum_repeat_s, double step_s);

  // Whether a pair that comes together faster than the bounce threshold strikes: at the beginning of its contact, after
  // a pause of the minimum repeat time without such blows, or when this one is more than twice as fast as the last one
  // that struck. All contact points of one step are one blow.
  bool strikes(BodyPair pair, double approach_m_s, double now_s);

  void touch(const Touching& touching, double now_s);

  // Ends the step. The tellings, in the order of their pairs, are valid until the next call.
  std::span<const Telling> advance(double now_s);

  [[nodiscard]] std::size_t size() const { return lives_.size(); }

 private:
  struct Life {
    double last_touch_s = 0;
    double last_blow_s = -1e300, heard_m_s = 0;
    bool told = false;
    int steps = 0;  // since it was told of last, as is what follows
    Vec3 impulse_ns, moment;
    double weight = 0, slip = 0, most_roll = 0;
    Vec3 over_first_m, over_second_m;              // way of the contact point over both surfaces, turned into the world
    int rolled = 0;                                // steps of that way
    bool touched_before = false, touches = false;  // in the step before, in this one
    Vec3 on_first_m, on_second_m;                  // the contact point in both frames
    Touching latest;
  };

  void add_way(Life& life, const Touching& touching) const;
  Telling tell(BodyPair pair, const Life& life) const;

  double minimum_repeat_s_, step_s_;
  int tell_every_;
  std::map<BodyPair, Life> lives_;
  std::vector<Telling> tellings_;
};

}  // namespace ringdown::scene
