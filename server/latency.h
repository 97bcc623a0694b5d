// The time from the arrival of an untimed event until it happens. The latency is constant, so that an evenly played
// rhythm sounds even at any block size. [any thread but audio]
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

// Returns the latency in frames: the wanted value, but at least one block, so that the frame is still to come, and a
// sixteenth of a block for the jitter of the clock.
synth::Frame latency_frames(const Driver& driver, const Latency& wanted = {});

}  // namespace ringdown::server
