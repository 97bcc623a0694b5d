// A door before what a real-time callback works on, which another thread may shut without the callback ever waiting.
//
//   callback:  if (gate.enter()) ...            owner:  gate.shut();   // returns when no callback is inside
//              else ... silence ...                     ...
//              gate.leave();                            gate.open();
//
// One callback at a time. Shut in the beginning.
#pragma once

#include "engine/base/realtime.h"

#include <atomic>
#include <chrono>
#include <thread>

namespace ringdown::server {

class Gate {
 public:
  // False when it is shut; leave() all the same. [audio]
  [[nodiscard]] bool enter() RINGDOWN_REALTIME {
    inside_.store(true);
    return open_.load();
  }
  void leave() RINGDOWN_REALTIME { inside_.store(false); }

  void open() { open_.store(true); }  // [the owner]
  void shut() {                       // [the owner]
    open_.store(false);
    wait();
  }

  // Returns when a callback that entered before has left: from then on callbacks see what was stored before this call.
  // [the owner]
  void wait() const {
    while (inside_.load()) std::this_thread::sleep_for(std::chrono::microseconds(50));
  }

 private:
  // All in one total order: a callback that does not see the door shut is seen inside.
  std::atomic<bool> open_ = false, inside_ = false;
};

}  // namespace ringdown::server
