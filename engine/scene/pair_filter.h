// Which bodies of a scene may touch: by their collision filters, and apart from pairs that a joint holds together.
// [one thread at a time]
#pragma once

#include "engine/scene/contact_point.h"
#include "engine/scene/description.h"

#include <cstdint>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

namespace ringdown::scene {

// Whether two bodies with these filters collide.
bool collide(const CollisionFilter& a, const CollisionFilter& b);

class PairFilter {
 public:
  // Bodies without a filter collide with everything that does not refuse them.
  void set(BodyId id, const CollisionFilter& filter);
  void forget(BodyId id) { filter_of_.erase(id); }

  void part(BodyId a, BodyId b) { parted_.insert(std::minmax(a, b)); }  // they do not touch from now on
  void unpart(BodyId a, BodyId b) { parted_.erase(std::minmax(a, b)); }

  // Cheap where no filter and no parted pair is known.
  [[nodiscard]] bool may_touch(BodyId a, BodyId b) const;

 private:
  [[nodiscard]] std::size_t filter_of(BodyId id) const;

  std::vector<CollisionFilter> filters_{CollisionFilter{}};  // those that differ; the first is that of most bodies
  std::vector<std::vector<bool>> collides_{{true}};          // by the numbers of two filters
  std::unordered_map<BodyId, std::size_t> filter_of_;        // of the bodies whose filter is not the first
  std::set<std::pair<BodyId, BodyId>> parted_;               // lower number first
};

}  // namespace ringdown::scene
