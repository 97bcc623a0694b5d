// What was last said of the listener, even if its frame is still to come. [any thread but audio]
#pragma once

#include "engine/base/rotation.h"
#include "engine/synth/event.h"

#include <atomic>
#include <mutex>
#include <optional>

namespace ringdown::session {

class ListenerMemory {
 public:
  struct Listener {
    bool on = false;
    Pose pose;
    double temperature_c = 20, humidity_percent = 50;
  };

  // Takes notice of an event of the listener; others are nothing to it.
  void keep(const synth::Event& event) {
    using synth::EventType;
    if (!synth::is_of_listener(event)) return;
    const std::scoped_lock lock(mutex_);
    if (event.type == EventType::listener_off && !last_) return;
    if (!last_) last_.emplace();
    if (event.type == EventType::listener_air) {
      last_->temperature_c = event.value;
      last_->humidity_percent = event.ramp_s;
      return;
    }
    last_->on = event.type == EventType::listener;
    if (last_->on) last_->pose = {event.point_m, event.rotation};
    on_ = last_->on;
  }

  // Nothing when there has never been a listener.
  [[nodiscard]] std::optional<Listener> last() const {
    const std::scoped_lock lock(mutex_);
    return last_;
  }

  // Whether there is a listener now; locks nothing.
  [[nodiscard]] bool on() const { return on_; }

 private:
  mutable std::mutex mutex_;
  std::optional<Listener> last_;
  std::atomic<bool> on_ = false;
};

}  // namespace ringdown::session
