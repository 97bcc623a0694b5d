// The events to come: one ring per producing thread, and the audio thread's heap of what waits for its frame.
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/spsc_ring.h"
#include "engine/synth/event.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ringdown::synth {

// Capacities. Past the first, push() returns false; past the second, events stay in their rings.
inline constexpr std::size_t kQueueCapacity = 4096;     // events one producer may have in its ring
inline constexpr std::size_t kMaxPendingEvents = 8192;  // events waiting for their frame
inline constexpr std::size_t kMaxPlacings = 4096;       // events that say where something is, taken in one block

enum class Producer : std::size_t { control, worker, scene, midi, kCount };

class EventQueue {
 public:
  struct Pending {
    Event event;
    std::uint64_t order = 0;  // among the events of one frame
    bool travelled = false;   // the frame is that at which it is heard
  };

  // Hands an event over. False when the producer's ring is full: the event was not taken. [the producer's thread]
  [[nodiscard]] bool push(Producer producer, const Event& event) RINGDOWN_REALTIME {
    return rings_[static_cast<std::size_t>(producer)].push(event);
  }

  // Takes what the producers pushed; an event whose frame has passed gets frame `now`. Returns how many events were
  // late. [audio]
  std::size_t accept(Frame now) RINGDOWN_REALTIME;

  // Those of the events that say where something is (is_placing()), in the order in which accept() took them, until the
  // next accept(). They wait for no frame. [audio]
  [[nodiscard]] std::span<const Event> placings() const RINGDOWN_REALTIME { return {placings_.data(), placed_}; }

  // The earliest event, if it happens before frame `end`, else null; of events at one frame the one pushed first.
  // [audio]
  [[nodiscard]] const Pending* next_before(Frame end) const RINGDOWN_REALTIME {
    return count_ > 0 && heap_.data()[0].event.frame < end ? heap_.data() : nullptr;
  }
  void pop() RINGDOWN_REALTIME;  // [audio]

  // Returns an event that was popped since the last accept() to its place among the others. [audio]
  void put_back(const Pending& pending) RINGDOWN_REALTIME;

  // Changes the length of a frame: every pending event, in the rings too, then comes `ratio` times as many frames after
  // `now` as before. Returns how many events were late. [worker, while nothing is rendered]
  std::size_t rescale(Frame now, double ratio);

 private:
  struct Later {
    bool operator()(const Pending& a, const Pending& b) const RINGDOWN_REALTIME {
      return a.event.frame != b.event.frame ? a.event.frame > b.event.frame : a.order > b.order;
    }
  };
  bool take(const Event& event, Frame now) RINGDOWN_REALTIME;

  using Ring = SpscRing<Event>;

  std::array<Ring, static_cast<std::size_t>(Producer::kCount)> rings_{Ring(kQueueCapacity), Ring(kQueueCapacity),
                                                                      Ring(kQueueCapacity), Ring(kQueueCapacity)};
  std::vector<Pending> heap_ = std::vector<Pending>(kMaxPendingEvents);  // earliest first
  std::vector<Event> placings_ = std::vector<Event>(kMaxPlacings);
  std::size_t count_ = 0, placed_ = 0;
  std::uint64_t next_order_ = 0;
};

}  // namespace ringdown::synth
