// A source of sound: an object that rings alone (object.h), or many objects that share their states (instance_group.h).
// The renderer, the shedding and the lists of active sources know nothing else of objects. [audio]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/modes/chunk.h"
#include "engine/synth/modes/fetch.h"
#include "engine/synth/events/event.h"
#include "engine/synth/events/event_queue.h"
#include "engine/synth/modes/level_histogram.h"

#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

class Object;

// An event of the chunk that is being rendered.
struct DueEvent {
  Event event;                 // its frame is not before the chunk
  Object* object = nullptr;    // that it happens to
  std::size_t offset = 0;      // frames into the chunk
  EventQueue::Pending queued;  // the event as it was taken off the queue
  bool waits = false;          // there was no time for it, so that it went back to the queue
  DueEvent* next = nullptr;    // of the same source
};

// The events of one source in this chunk, by frame. What is left on the list after the chunk had to wait for the next.
struct DueList {
  DueEvent *first = nullptr, *last = nullptr;
  void append(DueEvent& due) REALTIME {
    (first ? last->next : first) = &due;
    last = &due;
  }
};

class Source {
 public:
  // Plays the events of the chunk at their frames, adds what sounds to the workspace, and moves the states on.
  // Different sources may be rendered by different threads at the same time.
  virtual void render(const Chunk& chunk, Workspace& workspace) REALTIME = 0;

  // In place of render() when there is no time: mutes everything for this chunk. Events wait on the list.
  virtual void skip(const Chunk& chunk, Workspace& workspace) REALTIME = 0;

  // False while a force acts, which must not be interrupted.
  [[nodiscard]] virtual bool can_skip(const Chunk& chunk) const REALTIME = 0;

  // Finds what chunks of chunk.frames need, before several threads use it.
  virtual void prepare(const Chunk& chunk) REALTIME = 0;

  virtual void count_levels(const Chunk& chunk, LevelHistogram& histogram) REALTIME = 0;
  [[nodiscard]] virtual ModeStates::Counts counts() const REALTIME = 0;

  // Asks for memory that render() will read for a chunk of `frames` (fetch.h).
  virtual void fetch(FetchStage /*stage*/, std::size_t /*frames*/) const REALTIME {}

  DueList due;
  bool active = false;      // on the list of what is rendered
  bool look_again = false;  // its modes are to be compared with the threshold in this chunk (Shedding)

 protected:
  ~Source() = default;
};

}  // namespace ringdown::synth
