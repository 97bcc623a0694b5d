// How long after its arrival an untimed event happens. The latency is constant, so that a rhythm that is played evenly
// sounds evenly at any block size. [any thread but audio]
#pragma once

#include "engine/base/result.h"
#include "server/driver.h"

#include <optional>
#include <string>

namespace ringdown::server {

// The latency that the user wants, in frames or in seconds. Both empty: as short as possible.
struct Latency {
  std::optional<synth::Frame> frames;
  std::optional<double> seconds;
};

inline constexpr double kMaxLatency_s = 1;

// Reads "256", which means frames, or "5ms".
Result<Latency> parse_latency(const std::string& text);

// The latency in frames: what is wanted, but at least one block, so that the frame is still to come, and a sixteenth of
// a block for the jitter of the clock.
synth::Frame latency_frames(const Driver& driver, const Latency& wanted = {});

}  // namespace ringdown::server
