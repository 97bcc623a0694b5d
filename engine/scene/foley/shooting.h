// Finds the velocities with which bodies begin an interval of an animation, so that a simulation takes them to where
// the next frame shows them. [one thread at a time]
//
//   Shooting shooting(bodies, every_s, fire);  // `fire` simulates the interval
//   shooting.aim();
//   fire(shooting.bodies());  // once more, to take the contacts
#pragma once

#include "engine/scene/body_store.h"
#include "engine/scene/contact_point.h"

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace ringdown::scene {

// A body that is simulated from one frame to the next.
struct Shooter {
  Motion start;          // aim() corrects its velocity and its spin
  Pose target;           // of the centre of mass, in the next frame
  double reach_m = 0;    // the length that makes a way of an angle
  double trust = 1;      // weight of a correction against a miss, both as ways
  bool asleep = false;   // at the start
  bool rested = false;   // it lay still before: aim() may change `asleep`
  bool tracked = true;   // false: nothing is known of its velocity, and nothing is corrected
  bool guessed = false;  // the start is a guess: its island is given up sooner
  double miss_m = 0;     // result: distance from the target, turning included
  double shift_m = 0;    // result: the correction, as the way that it makes in the interval
  std::size_t island{};  // result: equal for bodies that pushed each other
};

// The simulated end of an interval.
struct Shot {
  std::vector<Motion> ends;                                // of the bodies
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  // of bodies that pushed each other
};

// The rotation vector from one rotation to another, the shorter way round [rad].
Vec3 turn_between(const Rotation& from, const Rotation& to);

class Shooting {
 public:
  using Fire = std::function<Shot(std::span<const Shooter>)>;
  using Six = std::array<double, 6>;  // ways: three of the centre of mass, three of turning [m]

  // The most bodies of an island that is searched in every way. More bodies lean on each other in contacts that begin
  // and end in each step, and more rounds bring them hardly nearer.
  static constexpr std::size_t kSmall = 4;

  Shooting(std::vector<Shooter> bodies, double every_s, Fire fire);

  // Corrects the starts. Calls `fire` up to some 200 times, mostly once.
  void aim();

  [[nodiscard]] std::span<const Shooter> bodies() const { return bodies_; }

 private:
  struct Island {
    std::vector<std::size_t> members;
    std::vector<std::vector<std::size_t>> near;  // of each member: the members that its start may move
    std::vector<std::size_t> color;              // of each member; members of one color move no member in common
    double cost = 0, damping = 0;
    bool open = false;  // not all have met their targets
  };
  struct Aim {
    std::vector<Six> shifts;
    std::vector<bool> asleep;
  };
  [[nodiscard]] std::vector<Shooter> starts_of(const Aim& aim) const;
  [[nodiscard]] Six miss_of(std::size_t n, const Motion& end) const;
  [[nodiscard]] bool may_shift(std::size_t n) const { return bodies_[n].tracked && !aim_.asleep[n]; }
  // Returns whether another start of a member of an island may bring a body nearer to its target.
  [[nodiscard]] bool may_help(const Island& island, std::size_t i) const;
  [[nodiscard]] double cost_of(const Island& island, const std::vector<Six>& misses, const Aim& aim) const;
  [[nodiscard]] bool any_open() const;
  [[nodiscard]] double worst_m(const Island& island) const;
  [[nodiscard]] double probe_of(const Island& island) const;
  void measure(Island& island) const;
  void group();
  bool attempt(const Aim& tried);
  void try_sleep();
  void find_slopes();
  bool descend();
  void scatter();
  void sharpen();
  void step_down(const Island& island, Aim& tried) const;

  std::vector<Shooter> bodies_;  // as given, until aim() ends
  double every_s_;
  Fire fire_;
  Aim aim_;  // the best so far, with its misses
  std::vector<Six> misses_;
  double met_m_, max_probe_m_, trust_share_ = 1;  // sharpen() lowers them
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
  bool regroup_ = false;
  std::vector<Island> islands_;
  std::vector<std::array<std::vector<std::pair<std::size_t, Six>>, 6>> slopes_;  // of each body's shifts: on bodies
  Random random_{1};
};

}  // namespace ringdown::scene
