// Items in disjoint groups (union-find). A group's root is its lowest item. [any thread]
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace ringdown::shatter {

class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }

  std::size_t root(std::size_t item) {
    while (parent_[item] != item) item = parent_[item] = parent_[parent_[item]];
    return item;
  }
  void join(std::size_t a, std::size_t b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace ringdown::shatter
