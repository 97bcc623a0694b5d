// A few threads that do the same thing to different parts. [one caller at a time]
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <thread>
#include <vector>

namespace ringdown::solve {

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

 private:
  void help(int number);

  std::vector<std::jthread> helpers_;
  const std::function<void(int)>* part_ = nullptr;  // null: go home
  std::atomic<unsigned> round_ = 0;
  std::atomic<int> busy_ = 0;
  std::vector<std::exception_ptr> failures_;
};

}  // namespace ringdown::solve
