// What happens in a rack, for those who tell others of it: subscribers (notifier.h) and recordings (recorder.h).
#pragma once

#include "engine/modal/damper.h"
#include "engine/synth/event.h"

namespace ringdown::session {

struct RackObject;

class Observer {
 public:
  virtual ~Observer() = default;

  // The mixer's queue has taken the event. By whoever pushed it, several threads at once; what notes do comes a moment
  // later, by tell_of_notes(). [any but audio]
  virtual void played(const synth::Event& event) = 0;

  // A new object, or a new bank for one that was there; a new material; another choice of modes; new dampers, or none;
  // a new group, or none; an end. [worker]
  virtual void loaded(const RackObject& object) = 0;
  virtual void retuned(const RackObject& object) = 0;
  virtual void selected(const RackObject& object) = 0;
  virtual void held(const RackObject& object, const modal::Dampers& changed, synth::Frame at) = 0;
  virtual void regrouped(const RackObject& object) = 0;
  virtual void freed(const RackObject& object) = 0;
};

}  // namespace ringdown::session
