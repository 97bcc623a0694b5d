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

// An argument of which only the type is kept: N (nil) and I (impulse), which have no value, and c (character), m (MIDI
// message), r (colour) and t (time tag), whose values no request uses.
struct Tag {
  char type = 'N';
  friend bool operator==(const Tag&, const Tag&) = default;
};

// An argument of OSC type i, h, f, d, s (also S, a symbol) or b, or a bool for T and F.
using Argument = std::variant<std::int32_t, std::int64_t, float, double, std::string, Blob, bool, Tag>;

struct Message {
  std::string address;
  std::vector<Argument> arguments;
  friend bool operator==(const Message&, const Message&) = default;
};

// Many numbers in one blob: float32, big-endian as all OSC numbers. decode_floats() ignores bytes after the last whole
// number, and returns 0 for a number that is not finite.
Blob encode_floats(std::span<const float> numbers);
std::vector<float> decode_floats(const Blob& blob);

// A message of a score (score.h).
struct ScoreEvent {
  double time_s = 0;  // time since the start of the score
  Message message;
};

}  // namespace ringdown::wire
