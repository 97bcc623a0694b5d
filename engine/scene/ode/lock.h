// The lock under which all calls into ODE are made. [any thread]
#pragma once

#include <cstddef>
#include <mutex>

namespace ringdown::scene {

// Held during every call into ODE. The first OdeLock of the process initialises ODE, the first one on a thread
// allocates ODE's data for that thread.
class OdeLock {
 public:
  OdeLock();

  // The number of ODE's warnings since the holder of the lock set it to 0. The only warning seen so far says that the
  // exact solver has left some contacts without a force, which happens in very symmetrical scenes.
  static std::size_t& warnings();

 private:
  std::lock_guard<std::mutex> lock_;
};

}  // namespace ringdown::scene
