// Reports events and changes in a rack to observers: subscribers (server/notifier.h), a recording (recorder.h), the
// audio driver.
//
// The worker reports changes of objects as it makes them. Events are reported later: each producer's thread puts the
// events that the mixer has taken into a ring, and report_events() empties the rings. So no strike waits for an
// observer.
#pragma once

#include "engine/base/spsc_ring.h"
#include "engine/synth/events/event.h"
#include "engine/synth/events/event_queue.h"
#include "server/session/broken_object.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

namespace ringdown::session {

struct ObjectState;

class Observer {
 public:
  virtual ~Observer() = default;

  // Called after the mixer's queue has taken the event, by Observers::report_events(), so a moment later and by one
  // thread at a time. Each producer's events come in order. [any but audio]
  virtual void played(const synth::Event& event) = 0;

  // Returns false while events may be lost that find the ring full. [the producers' threads]
  [[nodiscard]] virtual bool needs_events() const { return true; }

  // Called after an object has broken. [any but audio]
  virtual void broke(const BrokenObject& /*object*/) {}

  // Called after an object was added (`before` is null), removed (`after` is null) or changed. The change holds from
  // frame `at` on, if that is still to come. Gains and pans are not reported here, because they are events. [worker]
  virtual void changed(const ObjectState* before, const ObjectState* after, synth::Frame at) = 0;
};

class Observers {
 public:
  // Reports to `observer` until remove(). Call while no other thread uses the rack. [main]
  void add(Observer& observer) { observers_.push_back(&observer); }
  void remove(Observer& observer) { std::erase(observers_, &observer); }

  // Sets a function that is called after every change of an object, a bus or an input. [main, before anything is
  // loaded]
  void set_on_change(std::function<void()> on_change) { on_change_ = std::move(on_change); }

  // Grows with every change of an object, a bus or an input. [any]
  [[nodiscard]] std::uint64_t version() const { return version_; }

  // Stores an event that the mixer has taken, for report_events(). Locks nothing, unless synth::kQueueCapacity events
  // of this producer are already waiting and an observer needs them; those are then reported first. [the producer's
  // thread]
  void keep(synth::Producer producer, const synth::Event& event);

  // The ring for events that the audio thread has pushed to the mixer itself. Events that find the ring full are heard
  // but not reported.
  [[nodiscard]] SpscRing<synth::Event>& notes_played() { return played_by(synth::Producer::midi); }

  // Reports the events that were stored since the last call. Call several times a second. [any but audio]
  void report_events();

  // Reports a change of an object to the observers, and that something has changed. [worker]
  void report_change(const ObjectState* before, const ObjectState* after, synth::Frame at);

  // Reports that an object has broken. [any but audio]
  void report_broken(const BrokenObject& object);

  // Reports only that something has changed. [worker]
  void report_change();

 private:
  [[nodiscard]] SpscRing<synth::Event>& played_by(synth::Producer p) { return played_[static_cast<std::size_t>(p)]; }

  std::vector<Observer*> observers_;
  std::function<void()> on_change_;
  std::atomic<std::uint64_t> version_ = 0;
  // Events that each producer has pushed and the observers have not taken yet.
  std::array<SpscRing<synth::Event>, static_cast<std::size_t>(synth::Producer::kCount)> played_{
      SpscRing<synth::Event>(synth::kQueueCapacity), SpscRing<synth::Event>(synth::kQueueCapacity),
      SpscRing<synth::Event>(synth::kQueueCapacity), SpscRing<synth::Event>(synth::kQueueCapacity)};
  std::mutex reporting_;  // held by the thread that empties the rings
};

}  // namespace ringdown::session
