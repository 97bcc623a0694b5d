// The patterns of pieces into which a body breaks, as its bank holds them. [worker]
//
// Plain data, checked when it is read (fracture_file.h). A body has one or more patterns, for the places where it may
// be struck and for numbers of pieces. Every piece has a bank of its own, which may have no modes: such a piece clicks
// and never rings. All pieces are in the body's frame, so at the moment of the break a piece's pose is the body's.
//
// At the break each piece takes over the motion that it has as a part of the body (breaking.h), by a matrix of the
// body's motions and its own.
//
// Patterns of one place may be nested: then each piece of the finer one belongs to a piece of the pattern before it,
// which breaks again into the pieces that belong to it (fracture_of_piece()).
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

  // These two belong to a piece in a pattern that is nested in the one before:
  std::optional<std::size_t> coarser = {};  // the number of the piece that it belongs to, in the pattern before
  std::vector<float> from_coarser = {};     // BasicHandover::values for that piece's motions in place of the body's

  // The others belong to a piece that breaks again:
  double crack_area_m2 = 0;  // of the cracks between the pieces that belong to it, one face counted
  double skin_m2 = 0;        // the area of its skin, its cracks included; 0: unknown
  StressTable stress = {};   // of its modes; without points: unknown
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

// Returns the numbers of those pieces of the next pattern that belong to a piece, ascending; none if it does not break
// again.
std::vector<std::size_t> pieces_of_piece(const Fracture& fracture, std::size_t pattern, std::size_t piece);

// Returns how a piece breaks again: one pattern, whose pieces break again themselves by the Fracture of their own
// banks. Cracks begin at the piece's point that is nearest to the pattern's place. Null if fewer than two pieces belong
// to it. Copies their banks.
std::shared_ptr<const Fracture> fracture_of_piece(const Fracture& fracture, std::size_t pattern, std::size_t piece);

// Keeps the columns of the body's modes in `kept`, in that order; the body had `modes` modes.
void take_modes(Fracture& fracture, std::size_t modes, const std::vector<std::size_t>& kept);

// Keeps those numbers of the modes in `kept` of a piece that had `modes` modes, in that order, that lie outside its own
// bank: rows of its handovers, columns of those of its pieces, and its stress.
void take_modes_of_piece(Fracture& fracture, std::size_t pattern, std::size_t piece, std::size_t modes,
                         const std::vector<std::size_t>& kept);

}  // namespace ringdown::modal
