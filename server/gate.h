// Keeps a real-time callback away from data that another thread, the owner, is about to change. The owner waits for the
// callback; the callback never waits for the owner.
//
//   callback:  if (gate.enter()) ...            owner:  gate.shut();   // returns when no callback is inside
//              else ... silence ...                     ...
//              gate.leave();                            gate.open();
//
// One callback at a time. A new gate is shut.
#pragma once

#include "engine/base/realtime.h"

#include <atomic>
#include <chrono>
#include <thread>

namespace ringdown::server {

class Gate {
 public:
  // Returns false when the gate is shut; the callback calls leave() in either case. [audio]
  [[nodiscard]] bool enter() REALTIME {
    inside_.store(true);
    return open_.load();
  }
  void leave() REALTIME { inside_.store(false); }

  void open() { open_.store(true); }  // [the owner]
  void shut() {                       // [the owner]
    open_.store(false);
    wait();
  }

  // Returns when any callback that had entered before this call has left. Callbacks that enter later see everything
  // that was stored before this call. [the owner]
  void wait() const {
    while (inside_.load()) std::this_thread::sleep_for(std::chrono::microseconds(50));
  }

 private:
  // Sequentially consistent: a callback that misses shut() is itself visible to wait().
  std::atomic<bool> open_ = false, inside_ = false;
};

}  // namespace ringdown::server
