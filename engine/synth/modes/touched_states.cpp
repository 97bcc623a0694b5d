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
  const double energy =
      drive_touched(all, states_.table_.columns(), touch.forces, touch.ports, out, frames, touch.substeps);
  sane = energy <= kAbsurdEnergy && sane;
  if (!sane) states_.silence();
  return sane;
}

}  // namespace ringdown::synth
