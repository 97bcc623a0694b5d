// One process-wide lock for ODE, whose collision code keeps global state. [any thread]
#pragma once

#include <cstddef>
#include <mutex>

namespace ringdown::scene {

// Held during every call into ODE. The first OdeLock of the process initialises ODE, the first one on a thread
// allocates ODE's data for that thread.
class OdeLock {
 public:
  OdeLock();

 private:
  std::lock_guard<std::mutex> lock_;
};

// Sets the count of ODE's warnings to 0, and returns the count since. The only warning seen so far says that the exact
// solver has left some contacts without a force, which happens in very symmetrical scenes. Callers hold OdeLock.
void clear_ode_warnings();
std::size_t ode_warnings();

}  // namespace ringdown::scene
