// The events to come: one ring per producing thread, and the audio thread's heap of those that wait for their frames.
//
// Most verbs are small and wait inside of a QueuedEvent. The large ones, lasting contacts, wait in one of their
// producer's places beside the ring: the producer takes a place when it pushes, and the audio thread gives the place
// back when the event is over.
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/spsc_ring.h"
#include "engine/synth/events/event.h"

#include <algorithm>
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

enum class Producer : std::uint8_t { control, worker, scene, midi, kCount };

// An event as it waits.
struct QueuedEvent {
  static constexpr std::size_t kSmallVerb = 56;  // bytes of a verb that waits here

  Frame frame = 0;
  ObjectNumber object = 0;
  std::uint16_t place = 0;  // of a large verb
  std::uint8_t verb = 0;    // place in Verbs
  Producer producer = Producer::control;
  alignas(8) std::array<std::byte, kSmallVerb> small;
};
static_assert(sizeof(QueuedEvent) <= 128, "strikes, gains and poses are small");

class EventQueue {
 public:
  struct Pending {
    QueuedEvent event;
    std::uint64_t order = 0;  // among the events of one frame
    bool travelled = false;   // the frame is that at which it is heard
  };

  // Makes the places for large verbs. Must come before a large verb is pushed. [worker]
  void make_room() {
    for (Lane& lane : lanes_) lane.make_room();
  }

  // Hands an event over. False when the producer's ring or its places are full: the event was not taken. [the
  // producer's thread]
  [[nodiscard]] bool push(Producer producer, const Event& event) REALTIME;

  // Takes what the producers pushed; an event whose frame has passed gets frame `now`. Events that say where something
  // is (is_placing()) wait for no frame: `place(event)` is called for each. Returns how many events were late. [audio]
  template <class Place>
  std::size_t accept(Frame now, const Place& place) REALTIME {
    std::size_t late = 0, placed = 0;
    for (Lane& lane : lanes_) {
      for (; count_ < kMaxPendingEvents && placed < kMaxPlacings; lane.ring.pop()) {
        const QueuedEvent* event = lane.ring.front();
        if (!event) break;
        late += take(*event, now, place, placed);
      }
    }
    return late;
  }

  // The earliest event, if it happens before frame `end`, else null; of events at one frame the one pushed first.
  // [audio]
  [[nodiscard]] const Pending* next_before(Frame end) const REALTIME {
    return count_ > 0 && heap_[0].event.frame < end ? heap_.data() : nullptr;
  }
  // Takes the earliest event off the queue. Whoever pops an event puts it back or releases it. [audio]
  void pop() REALTIME;
  // Returns an event that was popped since the last accept() to its place among the others. [audio]
  void put_back(const Pending& pending) REALTIME;
  // The event is over. [audio]
  void release(const QueuedEvent& event) REALTIME;

  // The event that waits. [audio, until it is released]
  [[nodiscard]] Event event_of(const QueuedEvent& queued) const REALTIME;

  // Changes the length of a frame: every pending event, in the rings too, then comes `ratio` times as many frames after
  // `now` as before. Calls `place(event)` as accept() does. Returns how many events were late. [worker, while nothing
  // is rendered]
  template <class Place>
  std::size_t rescale(Frame now, double ratio, const Place& place) {
    std::size_t late = 0, placed = 0;
    for (Lane& lane : lanes_) {
      for (; const QueuedEvent* event = lane.ring.front(); lane.ring.pop()) {
        heap_.resize(std::max(heap_.size(), count_ + 1));  // those in the rings count the old frames, so all leave
        late += take(*event, now, place, placed);
      }
    }
    rescale_pending(now, ratio);
    return late;
  }

 private:
  static constexpr std::size_t kLargestVerb = Verbs::kMaxSize;
  struct Later {
    bool operator()(const Pending& a, const Pending& b) const REALTIME {
      return a.event.frame != b.event.frame ? a.event.frame > b.event.frame : a.order > b.order;
    }
  };
  // A producer's ring, and its places for large verbs.
  struct Lane {
    explicit Lane(std::size_t large_verbs) : places(large_verbs), free(large_verbs) {}
    void make_room();

    struct Large {
      alignas(Verb) std::array<std::byte, kLargestVerb> bytes;
    };
    SpscRing<QueuedEvent> ring{kQueueCapacity};
    std::size_t places;
    std::vector<Large> large;
    SpscRing<std::uint16_t> free;  // places of `large`, which the audio thread gives back
  };
  // Returns true when the event was late.
  template <class Place>
  bool take(const QueuedEvent& queued, Frame now, const Place& place, std::size_t& placed) REALTIME {
    if (!is_placing(effect_of(queued.verb))) return wait(queued, now);
    Event event = event_of(queued);
    event.frame = std::max(event.frame, now);
    place(event);
    ++placed;
    return false;
  }
  bool wait(const QueuedEvent& queued, Frame now) REALTIME;
  void rescale_pending(Frame now, double ratio);

  // Control and scene may fill their rings and the heap with contacts. MIDI notes bow, and the worker sends no
  // contacts.
  static constexpr std::size_t kAllContacts = kQueueCapacity + kMaxPendingEvents;
  std::array<Lane, static_cast<std::size_t>(Producer::kCount)> lanes_{Lane(kAllContacts), Lane(2), Lane(kAllContacts),
                                                                      Lane(2048)};
  std::vector<Pending> heap_ = std::vector<Pending>(kMaxPendingEvents);  // earliest first
  std::size_t count_ = 0;
  std::uint64_t next_order_ = 0;
};

}  // namespace ringdown::synth
