// Reports what happens in a rack: to subscribers (server/notifier.h), to a recording (recorder.h), to the audio driver.
//
// Changes of objects are reported by the worker as they are made. Events are reported later: each producer's thread
// puts those that the mixer has taken into a ring, and report_events() empties the rings. So a strike waits for no
// observer.
#pragma once

#include "engine/base/spsc_ring.h"
#include "engine/synth/events/event.h"
#include "engine/synth/events/event_queue.h"

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

  // The mixer's queue has taken the event. Called from Observers::report_events(), so a moment later and by one thread
  // at a time: each producer's events in their order. [any but audio]
  virtual void played(const synth::Event& event) = 0;

  // An object has come, when `before` is null, or gone, when `after` is, or changed: from frame `at` on, if that is
  // still to come. Gains and pans are not reported here, because they are events. [worker]
  virtual void changed(const ObjectState* before, const ObjectState* after, synth::Frame at) = 0;
};

class Observers {
 public:
  // Reports to `observer` from now on, until remove(). While no other thread uses the rack. [main]
  void add(Observer& observer) { observers_.push_back(&observer); }
  void remove(Observer& observer) { std::erase(observers_, &observer); }

  // Called whenever an object, a bus or an input has come, gone or changed. [main, before anything is loaded]
  void set_on_change(std::function<void()> on_change) { on_change_ = std::move(on_change); }

  // Grows with every change of an object, a bus or an input. [any]
  [[nodiscard]] std::uint64_t version() const { return version_; }

  // Keeps an event that the mixer has taken for report_events(). Locks nothing, unless synth::kQueueCapacity events of
  // this producer wait already: then they are reported first. [the producer's thread]
  void keep(synth::Producer producer, const synth::Event& event);

  // The ring for events that the audio thread has pushed to the mixer itself. Events that find the ring full are heard
  // but not reported.
  [[nodiscard]] SpscRing<synth::Event>& notes_played() { return played_by(synth::Producer::midi); }

  // Reports the events that were kept since the last call. Several times a second. [any but audio]
  void report_events();

  // Reports a change of an object to the observers, and that something has changed. [worker]
  void report_change(const ObjectState* before, const ObjectState* after, synth::Frame at);

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
