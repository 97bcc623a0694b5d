// A bank in another size and material, without its mesh and without a new analysis. [worker]
//
//   Result<Changed> bell = change(bank, {.size = 1.3, .material = bronze});
//
// Exact but for Poisson's ratio, which stays the bank's own: frequencies go as sqrt(E / rho) / size, shapes as
// rho^-1/2 size^-3/2, positions as size, mass as rho size^3, inertia as rho size^5 (docs/how/physics.md, "Another
// material"). The band goes with the modes: what lay above it was never found, so a bank that grows ends lower, and one
// that shrinks has no modes from the old lower end to the new one. All are kept that still have a pitch, in order of
// their importance, which depends on pitch. The pieces of a body that breaks change as bodies of their own.
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"

#include <optional>

namespace ringdown::bake {

struct Change {
  double size = 1;                          // > 0: the new lengths over the old ones
  std::optional<modal::Material> material;  // instead of the bank's; its Poisson's ratio does not count
};

struct Changed {
  modal::Bank bank;
  std::size_t over_damped = 0;  // modes that lost their pitch and are left out
};

// Fails when the bank does not say what it is made of and a material is given, and when no mode is left.
Result<Changed> change(const modal::Bank& bank, const Change& change);

}  // namespace ringdown::bake
