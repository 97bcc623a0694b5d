#include "engine/scene/pair_filter.h"

#include <algorithm>
#include <string>

namespace ringdown::scene {
namespace {

bool all_in(const std::vector<std::string>& systems, const std::vector<std::string>& list) {
  return std::ranges::all_of(systems, [&](const std::string& system) { return std::ranges::count(list, system) > 0; });
}

bool refuses(const CollisionFilter& one, const std::vector<std::string>& systems) {
  if (!one.only_with.empty() && (systems.empty() || !all_in(systems, one.only_with))) return true;
  return !one.not_with.empty() && !systems.empty() && all_in(systems, one.not_with);
}

}  // namespace

bool collide(const CollisionFilter& a, const CollisionFilter& b) {
  return !refuses(a, b.systems) && !refuses(b, a.systems);
}

void PairFilter::set(BodyId id, const CollisionFilter& filter) {
  filter_of_.erase(id);
  auto known = std::ranges::find(filters_, filter);
  if (known == filters_.end()) known = filters_.insert(known, filter);
  const auto number = static_cast<std::size_t>(known - filters_.begin());
  if (number == 0) return;
  filter_of_[id] = number;
  if (collides_.size() == filters_.size()) return;
  std::vector<bool>& row = collides_.emplace_back();
  for (const CollisionFilter& other : filters_) row.push_back(collide(filter, other));
  for (std::size_t k = 0; k < number; ++k) collides_[k].push_back(row[k]);
}

std::size_t PairFilter::filter_of(BodyId id) const {
  const auto found = filter_of_.find(id);
  return found == filter_of_.end() ? 0 : found->second;
}

bool PairFilter::may_touch(BodyId a, BodyId b) const {
  if (!parted_.empty() && parted_.contains(std::minmax(a, b))) return false;
  return filter_of_.empty() || collides_[filter_of(a)][filter_of(b)];
}

}  // namespace ringdown::scene
