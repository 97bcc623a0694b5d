// Decides which bodies of a scene may touch, from their collision filters and from the pairs that joints exclude. [one
// thread at a time]
#pragma once

#include "engine/scene/contact_point.h"
#include "engine/scene/description.h"

#include <cstdint>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

namespace ringdown::scene {

// Returns whether two bodies with these filters collide.
bool collide(const CollisionFilter& a, const CollisionFilter& b);

class PairFilter {
 public:
  // Bodies without a filter collide with everything that does not refuse them.
  void set(BodyId id, const CollisionFilter& filter);
  void forget(BodyId id) { filter_of_.erase(id); }

  void part(BodyId a, BodyId b) { parted_.insert(std::minmax(a, b)); }  // keeps two bodies from touching from now on
  void unpart(BodyId a, BodyId b) { parted_.erase(std::minmax(a, b)); }

  // Cheap if there are no filters and no parted pairs.
  [[nodiscard]] bool may_touch(BodyId a, BodyId b) const;

 private:
  [[nodiscard]] std::size_t filter_of(BodyId id) const;

  std::vector<CollisionFilter> filters_{CollisionFilter{}};  // distinct filters; the first is the empty one
  std::vector<std::vector<bool>> collides_{{true}};          // indexed by two filter numbers
  std::unordered_map<BodyId, std::size_t> filter_of_;        // filter numbers of bodies whose filter is not the first
  std::set<std::pair<BodyId, BodyId>> parted_;               // lower number first
};

}  // namespace ringdown::scene
