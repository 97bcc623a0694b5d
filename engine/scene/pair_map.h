// Values of pairs of bodies, in the order of the pairs. [one thread at a time]
#pragma once

#include "engine/scene/contact_point.h"

#include <cstddef>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

namespace ringdown::scene {

using BodyPair = std::pair<BodyId, BodyId>;  // the smaller number first

// A map optimised for access in order: the pair after the last one found is found without a search. Every step of a
// scene asks for all pairs that touch, in order.
template <class Value>
class PairMap {
 public:
  // Returns the value of a pair, creating it if there is none.
  Value& operator[](BodyPair pair) {
    const auto entry = map_.try_emplace(next_.value_or(map_.begin()), pair);
    next_ = std::next(entry);
    return entry->second;
  }

  // Calls `goes` with each pair and its value, in order, and removes the pairs for which it returns true. The next
  // search begins at the first pair.
  template <class Goes>
  void erase_if(const Goes& goes) {
    next_.reset();
    for (auto entry = map_.begin(); entry != map_.end();) {
      entry = goes(entry->first, entry->second) ? map_.erase(entry) : std::next(entry);
    }
  }
  void erase(BodyPair pair) {
    next_.reset();
    map_.erase(pair);
  }

  [[nodiscard]] std::size_t size() const { return map_.size(); }
  [[nodiscard]] auto begin() const { return map_.begin(); }
  [[nodiscard]] auto end() const { return map_.end(); }

 private:
  std::map<BodyPair, Value> map_;
  std::optional<typename std::map<BodyPair, Value>::iterator> next_;
};

}  // namespace ringdown::scene
