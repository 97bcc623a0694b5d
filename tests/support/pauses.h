// Pauses of the machine itself: a virtual one is stopped now and then, and no program can be blamed for what is late
// then.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace ringdown::test {

// One thread on each processor, above the priority of any audio thread, that wakes every millisecond. One that wakes
// more than two milliseconds late was kept from it by nothing that the machine runs.
class Pauses {
 public:
  Pauses();

  // Whether the threads have their priority; without it they tell nothing.
  [[nodiscard]] bool works() const { return works_; }
  [[nodiscard]] std::uint64_t count() const { return count_; }

 private:
  void watch(const std::stop_token& stop, std::size_t processor);

  std::atomic<bool> works_ = true;
  std::atomic<std::uint64_t> count_ = 0;
  std::vector<std::jthread> threads_;
};

}  // namespace ringdown::test
