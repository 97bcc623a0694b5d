// A liquid in the body of a finished bank, from the bank's shapes alone. [worker]
//
// The bank has neither the inside of the body nor modes above its band, so static corrections are left out that a bake
// with [fill] adds. Modes that bend the wall as the dry ones do, such as those of a glass's rim, come within some
// tenths of a percent. Others, in which the liquid pushes in a pattern that few dry modes have, are stated with their
// error or left out. docs/how/liquid.md has the equations.
#pragma once

#include "engine/bake/liquid/filling.h"
#include "engine/base/result.h"
#include "engine/modal/bank.h"

#include <string>

namespace ringdown::bake {

inline constexpr double kMaxFillError = 0.03;  // estimated, relative; modes of larger error are left out

struct FilledBank {
  modal::Bank bank;
  std::size_t left_out = 0;  // modes of the band whose error would exceed kMaxFillError
};

// Fills the basin; a body that could break no longer can. Fails with one sentence if the bank has no surface, no mass,
// nonlinear terms, a liquid or a tube already, or if the level cannot be (wet_body.h).
Result<FilledBank> fill_bank(const modal::Bank& bank, const Filling& filling);

}  // namespace ringdown::bake
