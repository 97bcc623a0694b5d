// Watches what the audio thread must never do: allocate or free, take locks, make system calls.
//
// Linking this file replaces the C library's entry points for those in the whole program by ones that count, and then
// do the real thing. They count only on a thread that has a RealtimeScope alive:
//
//   RealtimeScope scope;
//   mixer.render(left, right);
//   EXPECT_EQ(scope.seen().total(), 0u) << scope.seen().first;
//
// operator new and delete end in malloc and free, std::mutex in pthread_mutex_lock; both are seen there. For g++ and
// without sanitizers, which replace the same functions; otherwise kRealtimeGuardWorks is false and nothing is counted.
// Under clang preset `rtsan` watches instead.
#pragma once

#include <cstdint>

namespace ringdown::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(__clang__)
inline constexpr bool kRealtimeGuardWorks = false;
#else
inline constexpr bool kRealtimeGuardWorks = true;
#endif

struct RealtimeViolations {
  std::uint64_t allocations = 0;   // malloc, calloc, realloc, free, ...
  std::uint64_t locks = 0;         // mutexes, read-write locks, condition variables, semaphores, thread creation
  std::uint64_t system_calls = 0;  // read, write, open, mmap, nanosleep, poll, syscall (and so futex), ...
  const char* first = "";          // the first function that was called

  [[nodiscard]] std::uint64_t total() const { return allocations + locks + system_calls; }
};

// Counts on the thread that made it, from its construction to its end. Not nested.
class RealtimeScope {
 public:
  RealtimeScope();
  ~RealtimeScope();
  RealtimeScope(const RealtimeScope&) = delete;
  RealtimeScope& operator=(const RealtimeScope&) = delete;

  [[nodiscard]] RealtimeViolations seen() const;
};

}  // namespace ringdown::test
