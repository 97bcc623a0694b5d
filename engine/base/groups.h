// Items 0 ... count - 1 in disjoint groups (union-find). [any thread]
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace ringdown {

template <class Index = std::size_t>
class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), Index{0}); }

  // The item by which a group is known.
  Index root(Index item) {
    while (parent_[item] != item) item = parent_[item] = parent_[parent_[item]];
    return item;
  }
  // Joins two groups under the lower one of their roots, so that joined items have their lowest as root.
  void join(Index a, Index b) {
    const auto [low, high] = std::minmax({root(a), root(b)});
    parent_[high] = low;
  }
  // Joins the group of `a` to that of `b`, whose root stays.
  void join_to(Index a, Index b) { parent_[root(a)] = root(b); }

 private:
  std::vector<Index> parent_;
};

}  // namespace ringdown
