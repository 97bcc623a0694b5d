// Many numbers in one OSC blob: float32, big-endian as everything in OSC. [any thread but audio]
#pragma once

#include "protocol/wire/message.h"

#include <span>
#include <vector>

namespace ringdown::wire {

Blob encode_floats(std::span<const float> numbers);

// As many as the blob holds whole; a number that is not finite becomes 0.
std::vector<float> decode_floats(const Blob& blob);

}  // namespace ringdown::wire
