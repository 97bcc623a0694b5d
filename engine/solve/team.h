// A few threads that do the same thing to different parts. [one caller at a time]
#pragma once

#include <atomic>
#include <barrier>
#include <exception>
#include <functional>
#include <thread>
#include <vector>

namespace ringdown::solve {

// One of several threads that work on the same thing: each does its share, then they meet.
class Member {
 public:
  Member() = default;  // alone
  Member(int number, int count, std::barrier<>& meeting) : number_(number), count_(count), meeting_(&meeting) {}

  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] bool first() const { return number_ == 0; }

  // Whether item `i` of many like ones is this member's, when they go round.
  [[nodiscard]] bool has(int i) const { return i % count_ == number_; }

  // Where this member's even share of `items` begins; it ends where the next one's begins.
  template <class Int>
  [[nodiscard]] Int begin(Int items) const {
    return items * number_ / count_;
  }
  template <class Int>
  [[nodiscard]] Int end(Int items) const {
    return items * (number_ + 1) / count_;
  }

  // Waits until all have come here.
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

  // Calls part(0) .. part(size() - 1), part(0) here and the others on the helpers, and waits for all. The first
  // exception is thrown again here.
  void run(const std::function<void(int)>& part);

  // The same for work whose members meet. One that throws is not waited for.
  void run_together(const std::function<void(int, const Member&)>& part);

 private:
  void help(int number);

  std::vector<std::jthread> helpers_;
  const std::function<void(int)>* part_ = nullptr;  // null: go home
  std::atomic<unsigned> round_ = 0;
  std::atomic<int> busy_ = 0;
  std::vector<std::exception_ptr> failures_;
};

}  // namespace ringdown::solve
