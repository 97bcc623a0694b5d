// The bank of a bar with its tubes in another tuning, or with their mouths partly closed, from the bank as it was baked
// (docs/how/tubes.md). [worker]
//
//   Result<TubeBank> off = at_tuning(bank, {.detune_cents = -20});          // takes some microseconds
//   ModeTransfer retuned = transfer(as_tuned(bank).value(), off->modes, bank.mode_count());
//
// A bank has no record of bar and tube apart from each other, but for the tube's own mode omega_t in its notes. The two
// modes Omega that the tube's lowest one forms with a mode of the bar tell the rest, because sum and product of the
// eigenvalues of a matrix of 2 x 2 are known:
//
//   omega_1 = Omega_1 + Omega_2 - omega_t,        g^2 = -(Omega_1 - omega_t) (Omega_2 - omega_t)
//
// All tubes of a bank change alike. Other modes stay as they are.
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"
#include "engine/modal/mode_transfer.h"
#include "engine/modal/tubes/tube_tuning.h"

#include <array>
#include <complex>
#include <cstddef>
#include <vector>

namespace ringdown::modal {

// A mode of the bar and the tube's lowest one, as the two modes of the bank into which they couple.
struct TubePair {
  std::size_t bar = 0, tube = 0;               // modes of the bank
  std::array<std::complex<double>, 4> mixing;  // row by row: of bar and tube, in the first mode and in the second
  std::array<std::complex<double>, 2> phase;   // of each mode's motion over its state in the mixer, to a common phase
};

struct TubeModes {
  TubeTuning tuning;
  std::vector<TubePair> pairs;  // one for each tube
};

struct TubeBank {
  Bank bank;
  TubeModes modes;
};

// Fails with one sentence when the bank has no tube, when no two of its modes show a tube's pull, and when two tubes
// pull one mode.
Result<TubeModes> as_tuned(const Bank& bank);

// Fails as as_tuned() does. The bank is one as baked.
Result<TubeBank> at_tuning(const Bank& bank, const TubeTuning& tuning);

// A tuning that changes at once leaves the motion of bar and tube as it is, and so their energy. `modes` is the number
// of modes of the bank.
ModeTransfer transfer(const TubeModes& from, const TubeModes& to, std::size_t modes);

// The share of each mode's far field that comes out of a tube, 0 to 1; empty when no tube is heard.
std::vector<double> tube_shares(const Bank& bank);

}  // namespace ringdown::modal
