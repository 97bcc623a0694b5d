// The states of an object's modes while something touches it (touch_group.h): seen as they are, and moved on step by
// step under forces. [audio]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/kernels/drive_kernel.h"
#include "engine/synth/modes/mode_states.h"

#include <cstddef>
#include <span>

namespace ringdown::synth {

// The poles and forces that advance a touched object by one segment.
struct TouchForces {
  ModeArrays stepped;  // the poles of a step; its states do not count
  std::span<const Force> forces;
  PortForces ports;
  std::size_t substeps = 1;
  const double* leaning = nullptr;  // of the samples: what does not sound, because it only bends
  const double* sound = nullptr;    // what sounds in each step if modes have no gains of their own; null: not known
};

class TouchedStates {
 public:
  explicit TouchedStates(ModeStates& states) REALTIME : states_(states) {}

  // All states, of muted modes too, which sound again.
  [[nodiscard]] const StateArray& open() REALTIME {
    states_.unmute();
    return states_.states_;
  }
  // Adds samples to `out` and moves on: by touch.sound where it is known, or else by drive_touched(). False when a
  // state is absurd, as of render().
  bool render(const TouchForces& touch, double* out, std::size_t frames) REALTIME;

 private:
  ModeStates& states_;
};

}  // namespace ringdown::synth
