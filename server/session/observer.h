// What happens in a rack, for those who pass it on: to subscribers (server/notifier.h), to a recording (recorder.h).
#pragma once

#include "engine/synth/event.h"

namespace ringdown::session {

struct ObjectState;

class Observer {
 public:
  virtual ~Observer() = default;

  // The mixer's queue has taken the event. Called from Rack::report_events(), so a moment later and by one thread at a
  // time: each producer's events in their order. [any but audio]
  virtual void played(const synth::Event& event) = 0;

  // An object has come, when `before` is null, or gone, when `after` is, or changed: from frame `at` on, if that is
  // still to come. Gains and pans do not come here: they are events. [worker]
  virtual void changed(const ObjectState* before, const ObjectState* after, synth::Frame at) = 0;
};

}  // namespace ringdown::session
