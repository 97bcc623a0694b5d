// Pairs of bodies that may not touch each other yet: the pieces of a body that has just broken.
//
// The hulls of curved pieces reach into each other. If such pieces collided, they would be moved apart sideways, which
// is not physics, and a step with 28 of them would take 2 ms. So two pieces touch only once they have been apart.
// Pieces that never come apart stay a pair for good. Free of any physics engine. [one thread at a time]
#pragma once

#include "engine/scene/contact_point.h"
#include "engine/scene/solid.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace ringdown::scene {

// Pieces count as apart from this gap on.
inline constexpr double kFreshGap_m = 1e-4;

struct PosedHull {
  std::span<const double> points_m;  // x, y and z of each corner, about `position_m`
  Matrix3 turn;                      // to world axes
  Vec3 position_m;
};

// Returns true if a plane with a margin of `gap_m` parts the hulls. `direction` is where the search begins, a unit
// vector from the first hull to the second one, and becomes where it has come to; the search takes a few rounds, so for
// hulls that lie close to each other it may need several calls.
bool are_apart(const PosedHull& one, const PosedHull& two, double gap_m, Vec3& direction);

class FreshPairs {
 public:
  // Keeps every two of these bodies from touching. If they are the pieces of a body that is a piece itself, they may
  // not touch what that body may not touch yet, and become siblings of its siblings.
  void add(std::span<const BodyId> siblings, std::optional<BodyId> whole = {});
  void forget(BodyId id);

  [[nodiscard]] bool empty() const { return pairs_.empty(); }
  [[nodiscard]] bool contains(BodyId a, BodyId b) const {
    return !pairs_.empty() && std::ranges::binary_search(pairs_, key_of(a, b), {}, &Pair::key);
  }

  // Returns true if both were added together, whether or not they may touch by now.
  [[nodiscard]] bool are_siblings(BodyId a, BodyId b) const {
    if (family_of_.empty()) return false;
    const auto one = family_of_.find(a), two = family_of_.find(b);
    return one != family_of_.end() && two != family_of_.end() && one->second == two->second;
  }

  // Removes the pairs for which `parted(a, b, direction)` is true. The direction is kept for the next call; at first
  // it is zero.
  template <class Parted>
  void release(const Parted& parted) {
    std::size_t kept = 0;
    for (Pair& pair : pairs_) {
      if (parted(static_cast<BodyId>(pair.key >> 32), static_cast<BodyId>(pair.key), pair.direction)) continue;
      pairs_[kept++] = pair;
    }
    pairs_.resize(kept);
  }

 private:
  struct Pair {
    std::uint64_t key;
    Vec3 direction = {};
  };
  static std::uint64_t key_of(BodyId a, BodyId b) { return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b); }
  std::vector<Pair> pairs_;                       // by key
  std::unordered_map<BodyId, BodyId> family_of_;  // the first of the siblings
};

}  // namespace ringdown::scene
