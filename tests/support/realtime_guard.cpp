#include "tests/support/realtime_guard.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/mman.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <cstdlib>

namespace ringdown::test {
namespace {

// Constant-initialised, so that reading them can neither allocate nor call anything.
constinit thread_local bool watching = false;
constinit thread_local RealtimeViolations violations{};

using Counter = std::uint64_t RealtimeViolations::*;

[[maybe_unused]] void note(Counter counter, const char* name) {
  if (!watching) return;
  if (violations.total() == 0) violations.first = name;
  ++(violations.*counter);
}

}  // namespace

RealtimeScope::RealtimeScope() {
  violations = {};
  watching = true;
}
RealtimeScope::~RealtimeScope() { watching = false; }
RealtimeViolations RealtimeScope::seen() const { return violations; }

}  // namespace ringdown::test

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)

using ringdown::test::note;
using Seen = ringdown::test::RealtimeViolations;

// The C library's own names for its allocator: dlsym() could not be used here, because it allocates.
#pragma GCC visibility push(default)  // shared libraries find these
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) noexcept { return note(&Seen::allocations, "malloc"), __libc_malloc(size); }
void free(void* block) noexcept { note(&Seen::allocations, "free"), __libc_free(block); }
void* calloc(std::size_t count, std::size_t size) noexcept {
  return note(&Seen::allocations, "calloc"), __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) noexcept {
  return note(&Seen::allocations, "realloc"), __libc_realloc(block, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  return note(&Seen::allocations, "memalign"), __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return note(&Seen::allocations, "aligned_alloc"), __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  note(&Seen::allocations, "posix_memalign");
  *block = __libc_memalign(alignment, size);
  return *block ? 0 : ENOMEM;
}
}

namespace {

// The `name` that stands behind ours. Not a static local that is initialised once: threads that meet in its
// initialisation wait by syscall(), which would come back here.
template <class Function>
Function next_of(std::atomic<Function>& known, const char* name) {
  Function next = known.load(std::memory_order_relaxed);
  if (!next) known.store(next = reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name)), std::memory_order_relaxed);
  return next;
}

}  // namespace

// WATCH(counter, result, name, (parameters), (arguments)): stands before `name`, counts, and calls the next `name`. In
// C++ it is called watched_name and nowhere noexcept, whatever the C library declares: libjack cancels its threads
// inside such calls, and a cancelled thread unwinds through here, which noexcept would turn into std::terminate().
#define WATCH(counter, result, name, parameters, arguments)   \
  extern "C" result watched_##name parameters __asm__(#name); \
  extern "C" result watched_##name parameters {               \
    note(&Seen::counter, #name);                              \
    using Function = result(*) parameters;                    \
    static constinit std::atomic<Function> known = nullptr;   \
    return next_of(known, #name) arguments;                   \
  }

WATCH(locks, int, pthread_mutex_lock, (pthread_mutex_t * m), (m))
WATCH(locks, int, pthread_mutex_trylock, (pthread_mutex_t * m), (m))
WATCH(locks, int, pthread_mutex_unlock, (pthread_mutex_t * m), (m))
WATCH(locks, int, pthread_rwlock_rdlock, (pthread_rwlock_t * l), (l))
WATCH(locks, int, pthread_rwlock_wrlock, (pthread_rwlock_t * l), (l))
WATCH(locks, int, pthread_rwlock_unlock, (pthread_rwlock_t * l), (l))
WATCH(locks, int, pthread_cond_signal, (pthread_cond_t * c), (c))
WATCH(locks, int, pthread_cond_broadcast, (pthread_cond_t * c), (c))
WATCH(locks, int, pthread_cond_wait, (pthread_cond_t * c, pthread_mutex_t* m), (c, m))
WATCH(locks, int, pthread_cond_timedwait, (pthread_cond_t * c, pthread_mutex_t* m, const timespec* t), (c, m, t))
WATCH(locks, int, sem_wait, (sem_t * s), (s))
WATCH(locks, int, sem_timedwait, (sem_t * s, const timespec* t), (s, t))
WATCH(locks, int, sem_post, (sem_t * s), (s))
WATCH(locks, int, pthread_create,
      (pthread_t * thread, const pthread_attr_t* attributes, void* (*run)(void*), void* argument),
      (thread, attributes, run, argument))

WATCH(system_calls, ssize_t, read, (int fd, void* to, std::size_t size), (fd, to, size))
WATCH(system_calls, ssize_t, write, (int fd, const void* from, std::size_t size), (fd, from, size))
WATCH(system_calls, int, close, (int fd), (fd))
WATCH(system_calls, int, fsync, (int fd), (fd))
WATCH(system_calls, void*, mmap, (void* at, std::size_t size, int protection, int flags, int fd, off_t offset),
      (at, size, protection, flags, fd, offset))
WATCH(system_calls, int, munmap, (void* at, std::size_t size), (at, size))
WATCH(system_calls, int, nanosleep, (const timespec* time, timespec* left), (time, left))
WATCH(system_calls, int, clock_nanosleep, (clockid_t clock, int flags, const timespec* time, timespec* left),
      (clock, flags, time, left))
WATCH(system_calls, int, usleep, (useconds_t time), (time))
WATCH(system_calls, int, sched_yield, (), ())
WATCH(system_calls, int, poll, (pollfd * fds, nfds_t count, int timeout), (fds, count, timeout))
WATCH(system_calls, int, select, (int count, fd_set* in, fd_set* out, fd_set* error, timeval* timeout),
      (count, in, out, error, timeout))
WATCH(system_calls, ssize_t, send, (int fd, const void* from, std::size_t size, int flags), (fd, from, size, flags))
WATCH(system_calls, ssize_t, recv, (int fd, void* to, std::size_t size, int flags), (fd, to, size, flags))
WATCH(system_calls, ssize_t, sendto,
      (int fd, const void* from, std::size_t size, int flags, const sockaddr* to, socklen_t length),
      (fd, from, size, flags, to, length))
WATCH(system_calls, ssize_t, recvfrom,
      (int fd, void* to, std::size_t size, int flags, sockaddr* from, socklen_t* length),
      (fd, to, size, flags, from, length))

// The variadic ones pass on as many arguments as any of their callers can have given.
extern "C" int watched_open(const char* path, int flags, ...) __asm__("open");
extern "C" int watched_open(const char* path, int flags, ...) {
  note(&Seen::system_calls, "open");
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & O_CREAT) ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  static constinit std::atomic<int (*)(const char*, int, ...)> known = nullptr;
  return next_of(known, "open")(path, flags, mode);
}

extern "C" long watched_syscall(long number, ...) __asm__("syscall");
extern "C" long watched_syscall(long number, ...) {
  note(&Seen::system_calls, "syscall");
  va_list rest;
  va_start(rest, number);
  long a[6];
  for (long& argument : a) argument = va_arg(rest, long);
  va_end(rest);
  static constinit std::atomic<long (*)(long, ...)> known = nullptr;
  return next_of(known, "syscall")(number, a[0], a[1], a[2], a[3], a[4], a[5]);
}

#pragma GCC visibility pop
#endif
