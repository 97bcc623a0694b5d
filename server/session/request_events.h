// Converts requests of the mixer's lane to the mixer's events.
#pragma once

#include "engine/base/result.h"
#include "engine/synth/events/event.h"
#include "protocol/lanes.h"
#include "server/session/rack.h"

#include <vector>

namespace ringdown::session {

// Appends the events of `request` at `frame` to `events`: one event, or one for each strike or object if the request
// concerns several. Refuses objects that do not exist, and vertices and modes that a bank does not have; `events` may
// then contain a part of the request's events. [any but audio]
Result<void> append_events(const protocol::MixerRequest& request, const Rack& rack, synth::Frame frame,
                           std::vector<synth::Event>& events);

}  // namespace ringdown::session
