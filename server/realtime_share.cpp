#include "server/realtime_share.h"

#include <pthread.h>
#include <time.h>

#include <system_error>

namespace ringdown::server {
namespace {

constexpr double kLookEvery_s = 0.0005;

template <clockid_t kClock>
double seconds_of() {
  timespec time{};
  ::clock_gettime(kClock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

int schedule(int priority) {
  const sched_param parameters{.sched_priority = priority};
  return pthread_setschedparam(pthread_self(), priority > 0 ? SCHED_FIFO : SCHED_OTHER, &parameters);
}

}  // namespace

const RealtimeShare::System RealtimeShare::kSystem = {seconds_of<CLOCK_MONOTONIC>, seconds_of<CLOCK_THREAD_CPUTIME_ID>,
                                                      schedule};

Result<void> RealtimeShare::set_priority(int priority) {
  const int error = system_.set_priority(priority);
  priority_ = error == 0 ? priority : 0;
  raised_ = priority_ > 0;
  begin_s_ = -1;
  if (error == 0) return {};
  return fail(ErrorKind::refused, std::generic_category().message(error));
}

void RealtimeShare::turn() {
  if (priority_ == 0) return;
  const double now_s = system_.now_s();
  if (now_s - looked_at_s_ < kLookEvery_s) return;
  looked_at_s_ = now_s;
  const double used_s = system_.used_s();
  if (now_s - begin_s_ >= kPeriod_s) {
    begin_s_ = now_s;
    used_s_ = used_s;
    if (!raised_) raised_ = system_.set_priority(priority_) == 0;
  } else if (raised_ && used_s - used_s_ >= kMax_s) {
    raised_ = system_.set_priority(0) != 0;
  }
}

}  // namespace ringdown::server
