// Finds bodies and statics whose bounding boxes overlap, so that they may touch. Callers must hold OdeLock.
#pragma once

#include "engine/scene/ode/collider.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace ringdown::scene {

class NearPairs {
 public:
  using Pair = std::pair<Collider*, Collider*>;  // the smaller number first

  // Returns all such pairs with at least one awake body, ordered by their numbers, so that the order does not depend on
  // the bodies' positions. Valid until the next call.
  std::span<const Pair> find(std::span<Collider* const> colliders);

 private:
  struct Box {
    double range_m[6];  // low and high along x, y, z; infinite for a plane
    Collider* collider;
    BodyId id;
    bool awake;
  };
  struct Found {
    std::uint64_t numbers;  // both bodies' numbers, the smaller in the upper half
    Pair pair;
  };
  std::vector<Box> boxes_;
  std::vector<Found> found_;
  std::vector<Pair> pairs_;
};

}  // namespace ringdown::scene
