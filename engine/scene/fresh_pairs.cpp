#include "engine/scene/fresh_pairs.h"

#include "engine/scene/rotation.h"

#include <cstddef>
#include <limits>

// The search for a parting direction is that of K. Chung and W. Wang, "Quick collision detection of polytopes in
// virtual environments", 1996: the direction s is reflected at the plane across the line r between the two corners that
// reach farthest towards each other along s, until these corners lie apart.
namespace ringdown::scene {
namespace {

constexpr int kMaxRounds = 4;

// The corner that reaches farthest along a direction of the world.
Vec3 farthest(const PosedHull& hull, const Vec3& direction) {
  const Vec3 along = transpose(hull.turn) * direction;
  double best = -std::numeric_limits<double>::infinity();
  Vec3 corner;
  for (std::size_t k = 0; k + 2 < hull.points_m.size(); k += 3) {
    const Vec3 point{hull.points_m[k], hull.points_m[k + 1], hull.points_m[k + 2]};
    if (const double reach = dot(point, along); reach > best) {
      best = reach;
      corner = point;
    }
  }
  return hull.position_m + hull.turn * corner;
}

}  // namespace

bool are_apart(const PosedHull& one, const PosedHull& two, double gap_m, Vec3& direction) {
  for (int round = 0; round < kMaxRounds; ++round) {
    const Vec3 way = farthest(two, -1 * direction) - farthest(one, direction);
    const double gap = dot(way, direction), distance = length(way);
    if (gap > gap_m) return true;
    if (!(distance > 0)) return false;
    const Vec3 line = (1 / distance) * way;
    const Vec3 turned = direction - (2 * dot(line, direction)) * line;
    if (!(length(turned) > 0)) return false;
    direction = (1 / length(turned)) * turned;
  }
  return false;
}

void FreshPairs::add(std::span<const BodyId> siblings, std::optional<BodyId> whole) {
  if (siblings.empty()) return;
  const auto known = whole ? family_of_.find(*whole) : family_of_.end();
  const BodyId family = known == family_of_.end() ? siblings.front() : known->second;
  for (const BodyId id : siblings) family_of_[id] = family;
  if (whole) {
    const std::vector<Pair> before = pairs_;
    for (const Pair& pair : before) {
      const auto one = static_cast<BodyId>(pair.key >> 32), two = static_cast<BodyId>(pair.key);
      if (one != *whole && two != *whole) continue;
      for (const BodyId id : siblings) pairs_.push_back({key_of(one == *whole ? two : one, id), {}});
    }
  }
  for (std::size_t i = 0; i < siblings.size(); ++i) {
    for (std::size_t j = i + 1; j < siblings.size(); ++j) pairs_.push_back({key_of(siblings[i], siblings[j]), {}});
  }
  std::ranges::sort(pairs_, {}, &Pair::key);
}

void FreshPairs::forget(BodyId id) {
  if (family_of_.erase(id) == 0) return;
  std::erase_if(pairs_, [id](const Pair& pair) { return pair.key >> 32 == id || static_cast<BodyId>(pair.key) == id; });
}

}  // namespace ringdown::scene
