// A bar that breaks in two: a piece that takes its first modes, and one without a mode. No mesh is cut for it.
#pragma once

#include "engine/modal/fracture/fracture.h"
#include "tests/support/synthetic_bank.h"

#include <cmath>
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

// The pattern of a bar of 6 modes in `count` equal pieces, each with `modes` of the modes. Motion and energy of the bar
// are shared out evenly.
inline modal::BreakPattern even_pieces(std::size_t count, std::size_t modes) {
  const modal::Bank bar = quiet_bar_bank(6);
  const double share = 1 / static_cast<double>(count);
  const std::size_t columns = modal::kRigidMotions + bar.mode_count();
  modal::BreakPattern pattern{.at_m = {}, .crack_area_m2 = 1e-5 * static_cast<double>(count), .pieces = {}};
  for (std::size_t i = 0; i < count; ++i) {
    modal::PieceBank piece{.bank = quiet_bar_bank(modes)};
    piece.bank.mass = bar.mass;
    piece.bank.mass->mass_kg *= share;
    piece.bank.mass->inertia_kg_m2 = share * bar.mass->inertia_kg_m2;
    piece.handover.assign((modal::kRigidMotions + modes) * columns, 0);
    for (std::size_t k = 0; k < modal::kRigidMotions + modes; ++k)
      piece.handover[k * columns + k] = static_cast<float>(std::sqrt(share));
    pattern.pieces.push_back(std::move(piece));
  }
  return pattern;
}

// The bar in two equal pieces, each of which breaks again in two.
inline modal::Bank bar_in_two_and_four() {
  modal::Bank bar = quiet_bar_bank(6);
  modal::Fracture fracture{.patterns = {even_pieces(2, 6), even_pieces(4, 3)}};
  const modal::BreakPattern halves = even_pieces(2, 3);
  for (std::size_t i = 0; i < 4; ++i) {
    modal::PieceBank& piece = fracture.patterns[1].pieces[i];
    piece.coarser = i / 2;
    piece.from_coarser = halves.pieces[i % 2].handover;
  }
  for (modal::PieceBank& half : fracture.patterns[0].pieces) half.crack_area_m2 = 1e-5;
  bar.fracture = std::make_shared<const modal::Fracture>(std::move(fracture));
  return bar;
}

}  // namespace ringdown::test
