#include "server/turns.h"

#include "engine/base/within_memory.h"
#include "server/log.h"

#include <chrono>
#include <thread>

namespace ringdown::server {

void take_turns(const std::string& what, const std::stop_token& stop, const std::function<void()>& turn) {
  while (!stop.stop_requested()) {
    const auto taken = within_memory(what, [&turn]() -> Result<void> {
      turn();
      return {};
    });
    if (taken) continue;
    log_warning(taken.error().message);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

}  // namespace ringdown::server
