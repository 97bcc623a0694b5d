// The pitches of the keys of a MIDI keyboard, as deviations from equal temperament at A4 = 440 Hz, so that a tuning
// that does not deviate changes nothing, not even a rounding. [any thread]
#pragma once

#include <array>
#include <bitset>
#include <cstddef>

namespace ringdown::microtuning {

inline constexpr std::size_t kKeys = 128;
using KeySet = std::bitset<kKeys>;

struct KeyTuning {
  std::array<double, kKeys> semitones{};  // above equal temperament
  KeySet unmapped;                        // keys that strike nothing
  friend bool operator==(const KeyTuning&, const KeyTuning&) = default;
};

}  // namespace ringdown::microtuning
