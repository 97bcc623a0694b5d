// A bar that breaks in two: a piece that takes its first modes, and one without a mode. No mesh is cut for it.
#pragma once

#include "engine/modal/fracture/fracture.h"
#include "tests/support/synthetic_bank.h"

#include <cstddef>
#include <memory>
#include <utility>

namespace ringdown::test {

// A bar with little damping, which the pulse of a blow on the mixer leaves out while the pulse lasts.
inline modal::Bank quiet_bar_bank(std::size_t modes) {
  modal::Bank bar = bar_bank(modes);
  for (double& decay : bar.decay_per_s) decay *= 0.01;
  return bar;
}

// The first `shared` modes go on in the first piece; the second piece has none.
inline modal::Bank breaking_bar(std::size_t shared) {
  modal::Bank bar = quiet_bar_bank(6);
  modal::MassProperties half = *bar.mass;
  half.mass_kg /= 2;
  half.inertia_kg_m2 = 0.5 * half.inertia_kg_m2;
  modal::Fracture fracture;
  fracture.patterns.push_back({.at_m = {}, .crack_area_m2 = 1e-4, .pieces = {}});
  for (const std::size_t modes : {shared, std::size_t{0}}) {
    modal::PieceBank piece{.bank = quiet_bar_bank(modes == 0 ? 1 : modes)};
    piece.bank.mass = half;
    const std::size_t columns = modal::kRigidMotions + bar.mode_count();
    if (modes == 0) {
      modal::Bank silent{.name = "silent", .positions = piece.bank.positions, .material = bar.material, .mass = half};
      piece.bank = silent;
    }
    piece.handover.assign((modal::kRigidMotions + modes) * columns, 0);
    for (std::size_t m = 0; m < modes; ++m)
      piece.handover[(modal::kRigidMotions + m) * columns + modal::kRigidMotions + m] = 1;
    fracture.patterns[0].pieces.push_back(std::move(piece));
  }
  bar.fracture = std::make_shared<const modal::Fracture>(std::move(fracture));
  return bar;
}

}  // namespace ringdown::test
