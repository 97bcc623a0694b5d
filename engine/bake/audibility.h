// Which modes of a bank nobody can hear, and what is lost without them. [any thread]
//
// Every sample point, or every n-th of more than 2,000, is struck along the outward normal by a hard contact. Mode n
// then starts at the A-weighted amplitude
//
//   g_n(p) = G_n (phi_n(p) . normal(p)) A(f_n) hard_contact(f_n)                             (importance.h)
//
// with G_n the sound pressure at 1 m that a modal velocity of 1 radiates (modal/loudness.h),
//
// and falls by 8.7 d_n dB a second. At that point it is inaudible when either holds:
//
// - floor: both its first level and the energy that the ear collects of it in 0.2 s are more than floor_db below those
//   of the loudest mode there;
// - masking: one louder mode hides it (engine/modal/hearing/masking.h) from its start until it has fallen to the floor;
// the
//   loudest mode is taken as 60 dB SPL (played louder it hides more). Because levels are followed in time, a masker
//   that dies sooner does not mask. A mode that is itself dropped hides nothing.
//
// A mode is dropped only when it is inaudible at every point. Glancing blows, and listening louder than the floor
// allows for, can find it.
#pragma once

#include "engine/modal/bank.h"

#include <cstddef>
#include <vector>

namespace ringdown::bake {

inline constexpr double kOrderingFloor_db = 60;  // decides the order of modes where no floor is asked for

// One number for each mode: whether it can be heard anywhere. O(P M) to O(P M^2).
std::vector<bool> audible_modes(const modal::Bank& bank, double floor_db);

// The loss of a strike if only the first `kept` modes stay: the A-weighted energy of the missing part of the sound over
// that of the whole, over one minute, all products of modes included, in dB for the worst of the points.
// -300 when it is less than that, or nothing. O(P M^2).
double loss_db(const modal::Bank& bank, std::size_t kept);

struct Reduction {
  double floor_db = 0;  // drop what is inaudible; 0: drop nothing for that
  int keep = 0;         // then keep the first ones only; 0: all
  int always = 0;       // so many of the first modes stay where they are, whatever the other two ask
};

struct Reduced {
  int inaudible = 0, unimportant = 0;  // modes dropped by the one and by the other
  std::vector<std::size_t> kept;       // the modes that stay, in their new order, as numbers in the old one
};

// Puts modes that cannot be heard last, otherwise keeping their order; drops what is asked for, but at least one mode
// stays; and writes into bank.provenance what was dropped.
Reduced reduce(modal::Bank& bank, const Reduction& reduction);

}  // namespace ringdown::bake
