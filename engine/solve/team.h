// A few threads that run one function on different parts of the data. [one caller at a time]
#pragma once

#include <atomic>
#include <barrier>
#include <exception>
#include <functional>
#include <thread>
#include <vector>

namespace ringdown::solve {

// One of several threads that share a task. Each thread does its share, then all meet before the next task.
class Member {
 public:
  Member() = default;  // a team of one
  Member(int number, int count, std::barrier<>& meeting) : number_(number), count_(count), meeting_(&meeting) {}

  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] bool first() const { return number_ == 0; }

  // Returns true if item `i` belongs to this member when items are dealt in turn.
  [[nodiscard]] bool has(int i) const { return i % count_ == number_; }

  // The beginning and the end of this member's even share of `items`.
  template <class Int>
  [[nodiscard]] Int begin(Int items) const {
    return items * number_ / count_;
  }
  template <class Int>
  [[nodiscard]] Int end(Int items) const {
    return items * (number_ + 1) / count_;
  }

  // Waits until all members have called meet().
  void meet() const {
    if (meeting_ != nullptr) meeting_->arrive_and_wait();
  }

 private:
  int number_ = 0, count_ = 1;
  std::barrier<>* meeting_ = nullptr;
};

class Team {
 public:
  explicit Team(int threads);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  [[nodiscard]] int size() const { return static_cast<int>(helpers_.size()) + 1; }

  // Calls part(0) .. part(size() - 1) and waits for all: part(0) on the calling thread, the others on the helpers.
  // Rethrows the first exception on the calling thread.
  void run(const std::function<void(int)>& part);

  // Like run(), calls part(i, member) with members that can meet. Later meetings do not wait for a member that threw.
  void run_together(const std::function<void(int, const Member&)>& part);

 private:
  void help(int number);

  std::vector<std::jthread> helpers_;
  const std::function<void(int)>* part_ = nullptr;  // null: the helpers end
  std::atomic<unsigned> round_ = 0;
  std::atomic<int> busy_ = 0;
  std::vector<std::exception_ptr> failures_;
};

}  // namespace ringdown::solve
