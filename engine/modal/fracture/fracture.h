// The patterns of pieces into which a body breaks, as its bank holds them. [worker]
//
// Plain data, checked when it is read (fracture_file.h). A body has one or more patterns, for the places where it may
// be struck and for numbers of pieces. Every piece has a bank of its own, which may have no modes: such a piece clicks
// and never rings. All pieces are in the body's frame, so at the moment of the break a piece's pose is the body's.
//
// At the break each piece takes over the motion that it has as a part of the body (breaking.h), by a matrix of the
// body's motions and its own.
#pragma once

#include "engine/base/vec3.h"
#include "engine/modal/bank.h"
#include "engine/modal/fracture/breaking.h"
#include "engine/modal/fracture/peak_stress.h"
#include "engine/modal/fracture/strength.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace ringdown::modal {

inline constexpr std::size_t kMaxPieces = 1024;  // of all patterns of a body together
inline constexpr std::size_t kMaxPatterns = 64;

struct PieceBank {
  Bank bank;                    // with its mass; no mode: it does not ring
  std::vector<float> handover;  // BasicHandover::values
  double near_m = 0;            // distances of its nearest and its farthest point from the place of the blow: the
  double far_m = 0;             // crack around it opens from one to the other
  std::size_t model = 0;        // its number in the file that it was read from
};

struct BreakPattern {
  Vec3 at_m;                 // the place of the blow
  double crack_area_m2 = 0;  // of all cracks, one face counted
  std::vector<PieceBank> pieces;
};

struct Fracture {
  std::vector<BreakPattern> patterns;  // of one place: by ascending number of pieces
  StressTable stress;                  // of the body's modes; without points: unknown
  double skin_m2 = 0;                  // the area of the body's skin, which `strength` is drawn for
  std::optional<Strength> strength;    // of the body's material; nothing: unknown
  double crack_energy_j_m2 = 0;        // G_c of the body's material; 0: unknown, and cracks cost nothing
};

// Keeps the columns of the body's modes in `kept`, in that order; the body had `modes` modes.
void take_modes(Fracture& fracture, std::size_t modes, const std::vector<std::size_t>& kept);

}  // namespace ringdown::modal
