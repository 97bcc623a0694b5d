// Remembers the last message about the listener, even if its frame is still to come. [any thread; keep() neither locks
// nor allocates]
#pragma once

#include "engine/base/rotation.h"
#include "engine/synth/events/event.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <initializer_list>
#include <optional>

namespace ringdown::session {

class ListenerMemory {
 public:
  struct Listener {
    bool on = false;
    Pose pose;
    double temperature_c = 20, humidity_percent = 50;
  };

  // Stores an event of the listener; ignores all other events. If two threads call at one moment, each number comes
  // from one of the two events.
  void keep(const synth::Event& event) {
    if (!synth::is_of_listener(event)) return;
    if (event.verb.holds<synth::verb::ListenerOff>() && !known_) return;
    begun_.fetch_add(1);
    if (const auto* air = event.verb.get_if<synth::verb::ListenerAir>()) {
      store(kAir, {air->temperature_c, air->humidity_percent});
    } else if (const auto* listener = event.verb.get_if<synth::verb::Listener>()) {
      const auto& [at, turn] = listener->pose;
      store(0, {at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w});
      on_ = true;
    } else {
      on_ = false;
    }
    known_ = true;
    ended_.fetch_add(1);
  }

  // Returns nothing if there has never been a listener. Waits for threads that are just writing.
  [[nodiscard]] std::optional<Listener> last() const {
    std::array<double, kAir + 2> n{};
    bool on = false;
    std::uint64_t ended = 0;
    do {
      ended = ended_;
      for (std::size_t i = 0; i < n.size(); ++i) n[i] = numbers_[i];
      on = on_;
    } while (begun_ != ended);
    if (!known_) return {};
    const Pose pose{{n[0], n[1], n[2]}, Rotation::from_xyzw(n[3], n[4], n[5], n[6])};
    return Listener{on, pose, n[kAir], n[kAir + 1]};
  }

  // Returns true if there is a listener now.
  [[nodiscard]] bool on() const { return on_; }

 private:
  static constexpr std::size_t kAir = 7;  // position, rotation (x y z w), then the air's temperature and humidity

  void store(std::size_t first, std::initializer_list<double> values) {
    for (const double value : values) numbers_[first++] = value;
  }

  std::atomic<std::uint64_t> begun_ = 0, ended_ = 0;  // equal when nobody is writing
  std::array<std::atomic<double>, kAir + 2> numbers_ = {
      0, 0, 0, 0, 0, 0, 1, Listener{}.temperature_c, Listener{}.humidity_percent};
  std::atomic<bool> on_ = false, known_ = false;
};

}  // namespace ringdown::session
