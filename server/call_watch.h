// Detects that an audio server has stopped calling us.
//
//   CallWatch watch;                                      // a new one for each client
//   const auto silence = watch.look(client.calls(), may_be_silent, CallWatch::Clock::now());   // often
//   if (silence > kPatience) leave();
//
// Only time during which the watcher itself runs is counted, at most kMaxStep from one look to the next. A process that
// was stopped, or a machine that was suspended or too busy to run the watcher, says nothing about the server.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

namespace ringdown::server {

class CallWatch {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr Clock::duration kMaxStep = std::chrono::milliseconds(250);

  // Returns for how long the number of calls has not changed. Time in which the server `may_be_silent`, because it
  // waits for others or is inside a call, does not count and ends a silence.
  Clock::duration look(std::uint64_t calls, bool may_be_silent, Clock::time_point now) {
    if (last_look_) silence_ += std::clamp(now - *last_look_, Clock::duration::zero(), kMaxStep);
    last_look_ = now;
    was_called_ = was_called_ || calls > 0;
    if (calls != calls_ || may_be_silent) silence_ = {};
    calls_ = calls;
    return silence_;
  }

  [[nodiscard]] bool was_called() const { return was_called_; }

 private:
  std::uint64_t calls_ = 0;
  bool was_called_ = false;
  Clock::duration silence_{};
  std::optional<Clock::time_point> last_look_;
};

}  // namespace ringdown::server
