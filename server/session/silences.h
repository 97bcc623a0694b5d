// Mute and solo: which objects the mixer is to silence. While any object is soloed, the others are silent; a muted one
// always is. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/synth/mixer.h"
#include "server/session/object_state.h"

#include <set>
#include <vector>

namespace ringdown::session {

class Silences {
 public:
  // `mixer` must outlive it.
  explicit Silences(synth::Mixer& mixer) : mixer_(mixer) {}

  // Tells the mixer what has changed. `changed` is the successor of one of the objects, or a new object, that is not
  // among them yet; null: there is none. Fails when too many commands wait.
  Result<void> update(const std::vector<ObjectSnapshot>& objects, const ObjectState* changed = nullptr);

  // The object has been freed.
  void forget(synth::ObjectNumber object) { silent_.erase(object); }

 private:
  synth::Mixer& mixer_;
  std::set<synth::ObjectNumber> silent_;
};

}  // namespace ringdown::session
