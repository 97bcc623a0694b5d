#include "engine/synth/modes/touched_states.h"

namespace ringdown::synth {

bool TouchedStates::render(const TouchForces& touch, double* out, std::size_t frames) REALTIME {
  states_.wake();
  states_.threshold_ = states_.applied_ = kNoThreshold;
  ModeArrays all = states_.states_.for_kernel(0);
  all.pole_re = touch.stepped.pole_re;
  all.pole_im = touch.stepped.pole_im;
  states_.probes.touch(states_.states_, all, touch.forces, touch.ports, frames, touch.substeps);
  if (states_.fade_.running() && !states_.probes.all().empty()) states_.fade_.feel(states_.probes, frames);
  bool sane = !states_.fade_.running() || states_.fade_.render(out, frames);
  const std::size_t columns = states_.table_.columns();
  if (touch.sound != nullptr && all.hearing == nullptr) {
    sane = drive_touched(all, columns, {}, touch.ports, nullptr, frames, touch.substeps) <= kAbsurdEnergy && sane;
    for (std::size_t n = 0; n < frames && sane; ++n) out[n] += touch.sound[n * touch.substeps];
  } else {
    const double energy = drive_touched(all, columns, touch.forces, touch.ports, out, frames, touch.substeps);
    sane = energy <= kAbsurdEnergy && sane;
  }
  if (!sane) states_.silence();
  return sane;
}

}  // namespace ringdown::synth
