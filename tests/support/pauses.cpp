#include "tests/support/pauses.h"

#include <chrono>
#include <pthread.h>
#include <sched.h>

namespace ringdown::test {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

Pauses::Pauses() {
  for (std::size_t n = 0; n < std::thread::hardware_concurrency(); ++n) {
    threads_.emplace_back([this, n](const std::stop_token& stop) { watch(stop, n); });
  }
}

void Pauses::watch(const std::stop_token& stop, std::size_t processor) {
  cpu_set_t only;
  CPU_ZERO(&only);
  CPU_SET(processor, &only);
  const sched_param priority{.sched_priority = 90};
  if (pthread_setaffinity_np(pthread_self(), sizeof only, &only) != 0 ||
      pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority) != 0) {
    works_ = false;
    return;
  }
  while (!stop.stop_requested()) {
    const auto due = Clock::now() + 1ms;
    std::this_thread::sleep_until(due);
    if (Clock::now() > due + 2ms) ++count_;
  }
}

}  // namespace ringdown::test
