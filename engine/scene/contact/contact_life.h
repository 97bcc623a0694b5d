// The life of a contact between two bodies: it begins, perhaps with a strike, lasts while they slide, roll or rest, and
// ends.
//
// ContactLives receives once a step every pair that touches. It decides which of them strike, and reports the state of
// lasting contacts. A pair that parts and touches again within the minimum repeat time continues its contact, so that
// chatter is one contact and not a row of strikes. Free of any physics engine. [one thread at a time]
//
//   ContactLives lives(minimum_repeat_s, step_s);
//   lives.strikes(pair, approach_m_s, now_s);  // for a pair that comes together fast: does it strike?
//   lives.add(contact, now_s);                 // for any other pair that touches, once a step
//   for (const ContactReport& report : lives.advance(now_s)) ...
#pragma once

#include "engine/scene/pair_map.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace ringdown::scene {

// The interval at which a lasting contact is reported, unless the step is longer.
inline constexpr double kReportEvery_s = 0.004;

// A contact that slides and rolls more slowly than this rests, and is silent. A contact that sounds keeps sounding down
// to half of this speed, so that it does not flicker.
inline constexpr double kMinContactSpeed_m_s = 0.01;

// The contact of one pair in one step: all its points together. World axes.
struct PairContact {
  BodyPair pair;
  Vec3 point_m;             // mean of the contact points, weighted by their force
  Vec3 impulse_ns;          // received by the first body
  Vec3 normal;              // mean direction in which the first body leaves the second
  Vec3 slide_m_s;           // velocity of the first body's surface past the second's
  double max_roll_m_s = 0;  // bound on the rolling speed: spin times the distance to a centre of mass
  Motion first, second;     // for a static: rest at the origin
};

// The state of a lasting contact since its last report.
struct ContactReport {
  BodyPair pair;
  bool begins = false;                             // the first report of the contact
  bool ends = false;                               // the contact is over or rests; the other members have no meaning
  Vec3 point_m;                                    // world
  Vec3 force_n;                                    // on the first body, world: the mean
  Vec3 normal;                                     // mean of PairContact::normal
  Vec3 slide_m_s;                                  // mean, weighted by force
  double slip_m_s = 0;                             // mean magnitude of slide_m_s, weighted by force
  double roll_m_s = 0;                             // speed at which the contact point travels over both surfaces
  double over_first_m_s = 0, over_second_m_s = 0;  // the point's speed over each surface
  Motion first, second;
};

class ContactLives {
 public:
  ContactLives(double minimum_repeat_s, double step_s);

  // Returns whether a pair that comes together faster than the bounce threshold strikes: if it has not done so for the
  // minimum repeat time, or if it is more than twice as fast as the last strike. All contact points of a step are one
  // strike.
  bool strikes(BodyPair pair, double approach_m_s, double now_s);

  // Adds the contact of a pair in this step.
  void add(const PairContact& contact, double now_s);

  // Ends the contacts of a body that is about to go. Returns the last reports of those that were reported, valid until
  // the next call.
  std::span<const ContactReport> end(BodyId body);

  // Lets a pair go on in the place of another one: it strikes when the other one would have.
  void pass_on(BodyPair from, BodyPair to);

  // Ends the step. Returns the reports that are due, in the order of their pairs, valid until the next call.
  std::span<const ContactReport> advance(double now_s);

  [[nodiscard]] std::size_t size() const { return lives_.size(); }

 private:
  struct Life {
    double last_contact_s = 0;
    double last_impact_s = -1e300;  // time of the last fast approach
    double last_strike_m_s = 0;     // speed of the last strike
    bool reported = false;          // whether the contact was reported and its end was not
    // Sums since the last report:
    int steps = 0;
    Vec3 impulse_ns, moment, normals, slides;
    double weight = 0, slip = 0, max_roll = 0;
    Vec3 over_first_m, over_second_m;  // path of the contact point over both surfaces, in world axes
    int rolled = 0;                    // number of steps in that path
    bool touched_before = false;       // whether the pair touched in the last step
    bool touches = false;              // whether the pair touches in this step
    Vec3 on_first_m, on_second_m;      // the contact point in both bodies' frames
    PairContact latest;
  };

  void add_way(Life& life, const PairContact& contact) const;
  ContactReport report(BodyPair pair, const Life& life) const;

  double minimum_repeat_s_, step_s_;
  int report_every_;
  PairMap<Life> lives_;
  std::vector<ContactReport> reports_;
};

}  // namespace ringdown::scene
