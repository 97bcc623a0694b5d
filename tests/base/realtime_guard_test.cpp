// The watch over the audio thread proves itself: what it must see, it sees.
#include "tests/support/realtime_guard.h"

#include <gtest/gtest.h>
#include <linux/futex.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <thread>
#include <vector>

namespace ringdown::test {
namespace {

class RealtimeGuard : public testing::Test {
 protected:
  void SetUp() override {
    if (!kRealtimeGuardWorks) GTEST_SKIP() << "sanitizers and clang replace the watched functions";
  }

  template <class Action>
  static RealtimeViolations watch(Action&& action) {
    const RealtimeScope scope;
    action();
    return scope.seen();
  }
};

TEST_F(RealtimeGuard, ArithmeticViolatesNothing) {
  std::vector<double> values(1000, 1.0);
  const auto seen = watch([&] {
    for (double& value : values) value *= 1.5;
  });
  EXPECT_EQ(seen.total(), 0u) << seen.first;
}

TEST_F(RealtimeGuard, EveryKindOfAllocationIsCounted) {
  void* volatile block = nullptr;  // volatile, or the compiler removes what is never used
  std::string* volatile text = nullptr;
  EXPECT_EQ(watch([&] { text = new std::string("short"); }).allocations, 1u);
  EXPECT_EQ(watch([&] { delete text; }).allocations, 1u);
  EXPECT_EQ(watch([&] { block = std::calloc(3, 5); }).allocations, 1u);
  EXPECT_EQ(watch([&] { block = std::realloc(block, 50); }).allocations, 1u);
  EXPECT_EQ(watch([&] { free(block); }).allocations, 1u);
  std::vector<int> values;
  EXPECT_GE(watch([&] { values.push_back(1); }).allocations, 1u);
  EXPECT_EQ(watch([&] { block = std::aligned_alloc(64, 64); }).allocations, 1u);
  EXPECT_STREQ(watch([&] { free(block); }).first, "free");
}

TEST_F(RealtimeGuard, EveryKindOfLockIsCounted) {
  std::mutex mutex;
  EXPECT_EQ(watch([&] { const std::lock_guard lock(mutex); }).locks, 2u) << "lock and unlock";
  std::shared_mutex shared_mutex;
  EXPECT_EQ(watch([&] { const std::shared_lock lock(shared_mutex); }).locks, 2u);
  pthread_cond_t condition = PTHREAD_COND_INITIALIZER;
  EXPECT_EQ(watch([&] { pthread_cond_signal(&condition); }).locks, 1u);
}

TEST_F(RealtimeGuard, SystemCallsAreCounted) {
  char byte = 0;
  EXPECT_EQ(watch([&] { EXPECT_EQ(::write(-1, &byte, 1), -1); }).system_calls, 1u);
  const timespec no_time{};
  EXPECT_EQ(watch([&] { ::nanosleep(&no_time, nullptr); }).system_calls, 1u);
  EXPECT_EQ(watch([] { ::syscall(SYS_getpid); }).system_calls, 1u);
  EXPECT_EQ(watch([] {
              void* page = ::mmap(nullptr, 4096, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
              ::munmap(page, 4096);
            }).system_calls,
            2u);
}

TEST_F(RealtimeGuard, OnlyTheGuardsOwnThreadIsWatchedAndOnlyInItsScope) {
  std::thread other;
  {
    const RealtimeScope scope;
    other = std::thread([] { std::vector<int>(100).push_back(1); });
    EXPECT_GE(scope.seen().total(), 1u) << "starting a thread is seen";
  }
  other.join();
  std::vector<int>(100).push_back(1);
  const RealtimeScope scope;
  EXPECT_EQ(scope.seen().total(), 0u) << scope.seen().first;
}

// As libjack does to its threads, which wait in syscall() for their next block.
TEST_F(RealtimeGuard, AThreadCanBeCancelledInsideAWatchedCall) {
  std::atomic<int> word = 0;
  std::atomic<bool> began = false;
  std::thread waiting([&] {
    pthread_setcanceltype(PTHREAD_CANCEL_ASYNCHRONOUS, nullptr);
    began = true;
    for (;;) ::syscall(SYS_futex, &word, FUTEX_WAIT_PRIVATE, 0, nullptr, nullptr, 0);
  });
  while (!began) std::this_thread::yield();
  EXPECT_EQ(pthread_cancel(waiting.native_handle()), 0);
  waiting.join();
}

}  // namespace
}  // namespace ringdown::test
