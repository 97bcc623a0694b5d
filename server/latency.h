// How long after its arrival an untimed event happens: always the same, so that what is played in time sounds in time
// whatever the block size. [any thread but audio]
#pragma once

#include "engine/base/result.h"
#include "server/driver.h"

#include <optional>
#include <string>

namespace ringdown::server {

// As the user wants it. Both empty: as short as can be.
struct Latency {
  std::optional<synth::Frame> frames;
  std::optional<double> seconds;
};

inline constexpr double kMaxLatency_s = 1;

// "256" frames or "5ms".
Result<Latency> parse_latency(const std::string& text);

// At least one block, so that the frame is still to come, and a sixteenth of one for the clock's jitter: a wish for
// less gets that much.
synth::Frame latency_frames(const Driver& driver, const Latency& wanted = {});

}  // namespace ringdown::server
