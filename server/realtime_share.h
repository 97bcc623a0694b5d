// Real-time priority for a thread that others can keep busy, for half of the time at most.
//
// A thread of real-time priority that never rests takes its processor from everybody else, and the kernel then takes it
// back: for 50 ms in a second all of that processor's real-time threads wait, the audio thread among them
// (sched_rt_runtime_us in sched(7); newer kernels have a "fair server" for it). So in a flood this one becomes an
// ordinary thread for the rest of each 20 ms of which it has used 10.
//
//   RealtimeShare share;
//   share.set_priority(9);                 // on the thread itself, as all of this
//   for (;;) { share.turn(); work(); }     // a turn costs a reading of the clock
#pragma once

#include "engine/base/result.h"

namespace ringdown::server {

class RealtimeShare {
 public:
  static constexpr double kPeriod_s = 0.02, kMost_s = 0.01;

  // SCHED_FIFO; 0: an ordinary thread. Fails where the system does not allow it; the thread is then an ordinary one.
  Result<void> set_priority(int priority);

  // Several times a millisecond, if there is so much to do.
  void turn();

 private:
  int priority_ = 0;
  bool raised_ = false;
  double looked_at_s_ = -1, begin_s_ = -1, used_s_ = 0;  // in the period: where it began, processor time until then
};

}  // namespace ringdown::server
