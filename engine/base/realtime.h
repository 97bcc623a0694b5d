// Marks the functions that the audio thread may run, so that the compiler can check them.
//
// Every function that the audio thread may call carries REALTIME after its parameter list. Under
// clang >= 20 that is [[clang::nonblocking]]: -Wfunction-effects checks at compile time that nothing below it
// allocates, locks or throws, and RealtimeSanitizer checks the same at run time (preset `rtsan`). Under other
// compilers it is empty, and tests/support/realtime_guard.h watches malloc, locks and system calls instead.
#pragma once

#if defined(__clang__) && __clang_major__ >= 20
#define REALTIME [[clang::nonblocking]]
#else
#define REALTIME
#endif

// Between these two macros the compile-time check is off, for a call into a library whose functions are not marked.
// Each use says why the call is safe; RealtimeSanitizer still checks it at run time.
#if defined(__clang__) && __clang_major__ >= 20
#define TRUST_REALTIME_BEGIN _Pragma("clang diagnostic push") _Pragma("clang diagnostic ignored \"-Wfunction-effects\"")
#define TRUST_REALTIME_END _Pragma("clang diagnostic pop")
#else
#define TRUST_REALTIME_BEGIN
#define TRUST_REALTIME_END
#endif

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace ringdown {

// Flushes denormal numbers to zero on this thread for as long as the guard lives. JACK's threads start with denormals
// on, and a decaying tail in denormals was measured at 90 times the cost of a loud one. [any thread]
class DenormalGuard {
 public:
#if defined(__SSE2__)
  DenormalGuard() REALTIME : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | kFlushToZero | kDenormalsAreZero); }
  ~DenormalGuard() REALTIME { _mm_setcsr(saved_); }

 private:
  static constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
  unsigned saved_;
#elif defined(__aarch64__)
  DenormalGuard() REALTIME {
    asm volatile("mrs %0, fpcr" : "=r"(saved_));
    asm volatile("msr fpcr, %0" ::"r"(saved_ | kFlushToZero));
  }
  ~DenormalGuard() REALTIME { asm volatile("msr fpcr, %0" ::"r"(saved_)); }

 private:
  static constexpr unsigned long kFlushToZero = 1ul << 24;
  unsigned long saved_ = 0;
#endif

 public:
  DenormalGuard(const DenormalGuard&) = delete;
  DenormalGuard& operator=(const DenormalGuard&) = delete;
};

}  // namespace ringdown
