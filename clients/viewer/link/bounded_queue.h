// A queue that never grows past its bound, and counts the items lost because of it. [one thread at a time]
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>

namespace ringdown::viewer {

template <class Item>
class BoundedQueue {
 public:
  explicit BoundedQueue(std::size_t max) : max_(max) {}

  // Drops the new item when the queue is full: for requests, where the first ones matter.
  void push_or_drop(Item item) {
    if (items_.size() == max_) {
      ++lost_;
    } else {
      items_.push_back(std::move(item));
    }
  }

  // Drops the oldest item when the queue is full: for replies, where the last ones matter.
  void push_over(Item item) {
    if (items_.size() == max_) {
      items_.pop_front();
      ++lost_;
    }
    items_.push_back(std::move(item));
  }

  std::deque<Item> take() { return std::exchange(items_, {}); }
  void clear() { items_.clear(); }
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  std::size_t max_;
  std::deque<Item> items_;
  std::uint64_t lost_ = 0;
};

}  // namespace ringdown::viewer
