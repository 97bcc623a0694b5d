// Chooses the bounds of friction for islands that are solved again until the bounds agree with the solution's own
// normal impulses. Every island is judged by itself: what happens in one does not change the motion of another. Free of
// any physics engine. [any thread]
//
//   FrictionRounds rounds(contacts, islands);
//   rounds.meet(contact, island, asked_n);   // for each contact of the islands that have not ended
//   rounds.end_round();
//   ... the islands that have not ended are solved with bound_n(contact, island) ...
#pragma once

#include "engine/scene/fixed_contacts.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace ringdown::scene {

class FrictionRounds {
 public:
  // Contacts and islands have numbers below these.
  FrictionRounds(std::size_t contacts, std::size_t islands) : bounds_(contacts), islands_(islands) {}

  // Takes the bound of a contact that follows from the last solution of its island: the coefficient times the normal
  // force.
  void meet(std::size_t contact, std::size_t island, double asked_n);

  // Ends the round of all islands that have called meet().
  void end_round();

  // Returns whether an island keeps the motion of its last solution.
  [[nodiscard]] bool ended(std::size_t island) const { return islands_[island].ended; }

  // Returns the bound with which an island should be solved next. None: the solver should choose the bounds itself,
  // because no bounds agree; the island ends with that solution.
  [[nodiscard]] std::optional<double> bound_n(std::size_t contact, std::size_t island) const {
    return islands_[island].gives_up ? std::nullopt : std::optional(bounds_[contact].value());
  }

  // Call if the solver has failed. All islands that have not ended are then solved once more, without bounds. Returns
  // false if that has been tried.
  bool give_up();

 private:
  struct Island {
    double largest_n = 0, change_n = 0;  // over the contacts of the round
    double last = 0;                     // the change of the last round, as a share of the largest bound
    int contacts = 0, rounds = 0, stuck = 0;
    bool gives_up = false, ended = false;
  };
  void end_round(Island& island) const;

  std::vector<FrictionBound> bounds_;
  std::vector<Island> islands_;
  bool failed_ = false;
};

}  // namespace ringdown::scene
