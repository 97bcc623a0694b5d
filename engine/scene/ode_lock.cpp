#include "engine/scene/ode_lock.h"

#include <ode/ode.h>

#include <cassert>
#include <cstdarg>

namespace ringdown::scene {
namespace {

std::size_t warnings = 0;  // guarded by the mutex
void count_warning(int, const char*, va_list) { ++warnings; }

std::mutex& ode_mutex() {
  static std::mutex instance;
  return instance;
}

}  // namespace

OdeLock::OdeLock() : lock_(ode_mutex()) {
  static const int ready = dInitODE2(0);
  dSetMessageHandler(count_warning);
  thread_local const int allocated = dAllocateODEDataForThread(dAllocateMaskAll);
  assert(ready && allocated);
  static_cast<void>(ready), static_cast<void>(allocated);
}

void clear_ode_warnings() { warnings = 0; }
std::size_t ode_warnings() { return warnings; }

}  // namespace ringdown::scene
