// The modes of a body with tubes under it. [worker]
//
// The body alone was solved, and so was its radiation. Here each tube's modes become further modes (engine/tube), and
// those of the body change. A mode of both has a complex shape; a bank holds real ones. After a blow on the body, the
// two modes of a body's mode and its tube sound with opposite signs, however they are tuned, because the tube begins
// silent. So each shape is turned until it is real, and the sign goes into the shape: that keeps the sound of the tube
// exact. What the surface moves under a two-way contact is then overrated close to an exceptional point
// (docs/how/tubes.md).
#pragma once

#include "engine/bake/body_radiation.h"
#include "engine/bake/tubes/resonator.h"

#include <vector>

namespace ringdown::bake {

// Changes `heard` and the shapes of `modes`; shapes of the tubes' modes are appended to the latter. `body.modes` is
// `modes`, and the fields of `heard` are measured from `origin_m`. Progress stage: "tubes". Fails when cancelled, when
// a tube cuts the body, and when it cannot be tuned.
Result<std::vector<modal::ResonatorNote>> add_tubes(const RadiatingBody& body, const std::vector<Resonator>& resonators,
                                                    const modal::Air& air, const Vec3& origin_m, double band_high_hz,
                                                    BodyModes& modes, std::vector<HeardMode>& heard,
                                                    const Progress& progress);

}  // namespace ringdown::bake
