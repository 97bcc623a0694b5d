// An OSC message as plain data: no wire format, no library. [any thread]
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace ringdown::wire {

using Blob = std::vector<std::byte>;

// OSC types i, h, f, d, s, b. Others are refused where packets are decoded (codec.h).
using Argument = std::variant<std::int32_t, std::int64_t, float, double, std::string, Blob>;

struct Message {
  std::string address;
  std::vector<Argument> arguments;
  friend bool operator==(const Message&, const Message&) = default;
};

// Many numbers in one blob: float32, big-endian as everything in OSC. decode_floats() ignores bytes after the last
// whole number, and returns 0 for a number that is not finite.
Blob encode_floats(std::span<const float> numbers);
std::vector<float> decode_floats(const Blob& blob);

// A message of a score (score.h).
struct ScoreEvent {
  double time_s = 0;  // since the start
  Message message;
};

}  // namespace ringdown::wire
