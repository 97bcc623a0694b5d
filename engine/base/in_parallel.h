// Divides work among threads that live as long as the call. [worker]
#pragma once

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <thread>
#include <vector>

namespace ringdown {

// Returns the number of threads to use: `wanted` if above 0; else $RINGDOWN_THREADS if above 0; else the number of
// processors.
inline int thread_count(int wanted) {
  if (wanted > 0) return wanted;
  const char* allowed = std::getenv("RINGDOWN_THREADS");
  const int threads = allowed == nullptr ? 0 : std::atoi(allowed);
  return threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

// Calls work(0) ... work(count - 1), each on its own thread and work(0) on the caller's, and returns after all calls.
// If several throw, the exception of the lowest number is rethrown.
template <class Work>
void in_parallel(int count, const Work& work) {
  std::vector<std::exception_ptr> failures(count);
  const auto guarded = [&](int number) {
    try {
      work(number);
    } catch (...) {
      failures[number] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (int number = 1; number < count; ++number) others.emplace_back(guarded, number);
    guarded(0);
  }
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace ringdown
