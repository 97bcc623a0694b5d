#include "engine/scene/ode/lock.h"

#include <ode/ode.h>

#include <cassert>
#include <cstdarg>

namespace ringdown::scene {
namespace {

std::mutex& ode_mutex() {
  static std::mutex instance;
  return instance;
}

void count_warning(int, const char*, va_list) { ++OdeLock::warnings(); }

}  // namespace

OdeLock::OdeLock() : lock_(ode_mutex()) {
  static const int ready = dInitODE2(0);
  dSetMessageHandler(count_warning);
  thread_local const int allocated = dAllocateODEDataForThread(dAllocateMaskAll);
  assert(ready && allocated);
  static_cast<void>(ready), static_cast<void>(allocated);
}

std::size_t& OdeLock::warnings() {
  static std::size_t count = 0;
  return count;
}

}  // namespace ringdown::scene
