// Plays the embedded scene like an outside simulator: sends its strikes to another daemon as OSC, in the messages that
// a game would send.
#pragma once

#include "engine/base/result.h"
#include "server/driver.h"
#include "server/frame_clock.h"
#include "server/session/rack.h"
#include "server/session/scene_player.h"

#include <string>

namespace ringdown::server {

// Returns a sink that sends strikes to the daemon at `url` (osc.udp://host:port) in bundles, whose time tag is the
// moment at which our driver would play their frame. Objects are identified by name. `rack` and `driver` must outlive
// the sink.
Result<session::ScenePlayer::Sink> open_remote_strikes(const std::string& url, const session::Rack& rack,
                                                       const Driver& driver, Clocks clocks = {});

}  // namespace ringdown::server
