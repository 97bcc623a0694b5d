// How a body breaks: the patterns of pieces that its bank holds. [worker]
//
// Plain data, checked when it is read (fracture_file.h). A body has one or more patterns, for the places where it may be
// struck and for numbers of pieces. Every piece has a bank of its own, which may have no modes: such a piece clicks and
// never rings. All pieces are in the body's frame, so at the moment of the break a piece's pose is the body's.
//
// At the break each piece takes over the motion that it has as a part of the body. With the body's motions phi_j (six
// rigid ones, then the M modes of its bank) and the piece's motions psi_k (six rigid ones, then its K modes), all
// orthonormal in the mass of body and piece,
//
//   r_k = sum over j of P_kj q_j,      P_kj = integral over the piece of rho psi_k . phi_j.
//
// P has no unit and does not change with size, stiffness or density. Rigid motions of a body with mass m, centre c,
// principal axes a_i and moments I_i are a_i / sqrt(m), i = 1..3, and a_i x (x - c) / sqrt(I_i).
#pragma once

#include "engine/base/vec3.h"
#include "engine/modal/bank.h"
#include "engine/modal/material_scale.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace ringdown::modal {

inline constexpr std::size_t kRigidMotions = 6;
inline constexpr std::size_t kMaxPieces = 1024;  // of all patterns of a body together
inline constexpr std::size_t kMaxPatterns = 64;

struct Piece {
  Bank bank;                    // with its mass; no mode: it does not ring
  std::vector<float> handover;  // P: (6 + K) x (6 + M), one row after the other
  double near_m = 0;            // distances of its nearest and its farthest crack from the place of the blow: the crack
  double far_m = 0;             // opens from one to the other
};

struct BreakPattern {
  Vec3 at_m;                // the place of the blow
  double crack_area_m2 = 0;  // of all cracks, one face counted
  std::vector<Piece> pieces;
};

struct Fracture {
  std::vector<BreakPattern> patterns;  // of one place: by ascending number of pieces
};

// Returns the patterns of a body of another size, stiffness or density. Modes of pieces that would no longer ring are
// left out.
Fracture scaled(const Fracture& fracture, const MaterialScale& scale);

// Keeps the columns of the body's modes in `kept`, in that order; the body had `modes` modes.
void take_modes(Fracture& fracture, std::size_t modes, const std::vector<std::size_t>& kept);

}  // namespace ringdown::modal
