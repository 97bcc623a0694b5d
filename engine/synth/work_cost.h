// The costs of the kinds of work. The unit is the cost of one mode in one chunk by moments, some 1.4 ns with AVX-512.
// Measured by `./run bench mixer --only budget`.
#pragma once

#include <cstddef>

namespace ringdown::synth {

inline constexpr std::size_t kMomentsFixed = 1100;  // of moments, once in a chunk
inline constexpr std::size_t kFramesPerMode = 28;   // frames for which tables cost a mode 1
inline constexpr double kStrikePerMode = 9;         // a strike on an object that rings alone,
inline constexpr double kSharedStrikePerMode = 12;  // and on one whose states are shared
inline constexpr double kJoinPerMode = 1.5;         // sharing states, and no longer
inline constexpr double kDrivePerMode = 6;          // a force that lasts for a chunk
inline constexpr double kTouchPerMode = 9;          // of an object that is touched, for a chunk of steps,
inline constexpr double kTouchPerContact = 20000;   // and of each two-way contact
inline constexpr double kCoupledPerTerm = 0.005;    // modes that exchange energy: a frame of one number of H
inline constexpr double kEnterPerMode = 1.5;        // bringing a muted mode back, beside rendering it
inline constexpr double kLookPerMode = 0.3;         // finding how loud a mode is,
inline constexpr double kLookPerMuted = 0.05;       // and a muted one

// The cost of rendering `modes` modes for a chunk of `frames`.
constexpr double render_units(std::size_t modes, std::size_t frames, bool moments) {
  const auto each = moments ? 1.0 : static_cast<double>(frames) / static_cast<double>(kFramesPerMode);
  return each * static_cast<double>(modes);
}

}  // namespace ringdown::synth
