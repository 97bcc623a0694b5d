// The costs of the kinds of work. The unit is the cost of one mode in one chunk by moments, some 1.4 ns with AVX-512.
// Measured by `./run bench mixer --only budget`.
#pragma once

#include <cstddef>

namespace ringdown::synth {

inline constexpr std::size_t kMomentsFixed = 1100;  // fixed cost of moments per chunk
inline constexpr std::size_t kFramesPerMode = 28;   // frames that cost one unit per mode with tables
inline constexpr double kStrikePerMode = 9;         // a strike on an object that rings alone
inline constexpr double kSharedStrikePerMode = 12;  // a strike on an object whose states are shared
inline constexpr double kJoinPerMode = 1.5;         // beginning or ending to share states
inline constexpr double kDrivePerMode = 6;          // a lasting force, per chunk
inline constexpr double kProbePerMode = 6;          // a place whose motion is an output, per chunk
inline constexpr double kTouchPerMode = 9;          // a touched object, per chunk of steps
inline constexpr double kTouchPerContact = 20000;   // a two-way contact, per chunk
inline constexpr double kCoupledPerTerm = 0.005;    // modes that exchange energy, per frame and number of H
inline constexpr double kEnterPerMode = 1.5;        // bringing a muted mode back, in addition to rendering it
inline constexpr double kLookPerMode = 0.3;         // finding the level of a mode
inline constexpr double kLookPerMuted = 0.05;       // finding the level of a muted mode

// Returns the cost of rendering `modes` modes for a chunk of `frames`.
constexpr double render_units(std::size_t modes, std::size_t frames, bool moments) {
  const auto each = moments ? 1.0 : static_cast<double>(frames) / static_cast<double>(kFramesPerMode);
  return each * static_cast<double>(modes);
}

}  // namespace ringdown::synth
