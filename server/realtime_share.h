// Gives a thread real-time priority for at most half of the time, because other programs could keep the thread busy for
// ever.
//
// When a thread of real-time priority never rests, the kernel stops all real-time threads of its processor for 50 ms in
// each second, the audio thread among them (sched_rt_runtime_us in sched(7); newer kernels have a "fair server" for
// it). A thread with a RealtimeShare therefore becomes an ordinary thread for the rest of each 20 ms once it has used
// 10 of them.
//
//   RealtimeShare share;
//   share.set_priority(9);                 // all functions are called on the thread itself
//   for (;;) { share.turn(); work(); }     // a turn costs a reading of the clock
#pragma once

#include "engine/base/result.h"

namespace ringdown::server {

class RealtimeShare {
 public:
  static constexpr double kPeriod_s = 0.02, kMax_s = 0.01;

  // The functions of the system that a share uses; tests replace them.
  struct System {
    double (*now_s)();   // a clock that is never set
    double (*used_s)();  // the processor time of this thread
    // Gives this thread SCHED_FIFO at this priority; 0 makes an ordinary thread. Returns 0 or an error number.
    int (*set_priority)(int number);
  };
  static const System kSystem;

  explicit RealtimeShare(System system = kSystem) : system_(system) {}

  // Sets SCHED_FIFO at this priority; 0 makes an ordinary thread. If the system refuses, the thread stays ordinary and
  // the error says why.
  Result<void> set_priority(int priority);

  // Call between any two pieces of work; in a flood that is several times a millisecond.
  void turn();

 private:
  System system_;
  int priority_ = 0;
  bool raised_ = false;
  double looked_at_s_ = -1, begin_s_ = -1, used_s_ = 0;  // start of the period, and processor time at that moment
};

}  // namespace ringdown::server
