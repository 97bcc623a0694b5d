// A recording's modes as a bank that plays them: one sample point, which moves along the recorded blow. [any]
#pragma once

#include "engine/base/vec3.h"
#include "engine/fit/modes.h"
#include "engine/modal/bank.h"

#include <span>
#include <string>

namespace ringdown::fit {

struct Blow {
  Vec3 impulse_ns = {0, 0, 1};  // what shall sound as loud as the recording; not 0
  double contact_time_s = 0;    // with this contact time, F(f) of which is divided out, by 20 dB at most
};

// `loudness`: a mode's amplitude in the mixer's output over 2 pi f F(f) (phi . j), for one channel and an object in the
// centre (docs/physics.md, "A strike"). Shapes have the sign of the recorded sine at the onset: the mixer's sines begin
// at phase 0, so of the recorded phases no more than that can be kept.
modal::Bank to_bank(std::span<const Mode> modes, const Blow& blow, double loudness, const std::string& name);

}  // namespace ringdown::fit
