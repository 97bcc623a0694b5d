// Tells the mixer which objects to silence, by mute and solo. While any object is soloed, objects that are not soloed
// are silent; a muted object is always silent. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/synth/mixer.h"
#include "server/session/object_state.h"

#include <set>
#include <vector>

namespace ringdown::session {

class Silences {
 public:
  // `mixer` must outlive this object.
  explicit Silences(synth::Mixer& mixer) : mixer_(mixer) {}

  // Sends changes to the mixer. `changed` is the new state of one of the objects, or a new object, and is not yet among
  // `objects`; null if there is none. Fails if too many commands are waiting.
  Result<void> update(const std::vector<ObjectSnapshot>& objects, const ObjectState* changed = nullptr);

  // Call after an object was freed.
  void forget(synth::ObjectNumber object) { silent_.erase(object); }

 private:
  synth::Mixer& mixer_;
  std::set<synth::ObjectNumber> silent_;
};

}  // namespace ringdown::session
