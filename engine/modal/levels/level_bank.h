// The bank of a body with its liquid at another level, from the matrices that its own bank keeps (liquid_levels.h).
// [worker]
//
//   Result<LevelBank> half = at_level(bank, 0.05);                // takes some milliseconds
//   ModeTransfer retuned = transfer(as_baked(bank), half->modes);  // what becomes of modes that ring
//
// Modes keep the number of the mode of the bank that moves like them. Decays, shapes and fields change, too; a field is
// the sum of those of the bank's modes.
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"
#include "engine/modal/levels/liquid_levels.h"
#include "engine/modal/mode_transfer.h"

#include <vector>

namespace ringdown::modal {

// The modes at one level, in the columns of the bank's levels.
struct LevelModes {
  double level_m = 0;
  std::vector<double> mixing;       // (N + J) x M
  std::vector<double> mass;         // (N + J)^2: of body and liquid
  std::vector<double> omega_rad_s;  // M: undamped
};

struct LevelBank {
  Bank bank;
  LevelModes modes;
};

// Fails with one sentence when the bank has no levels, or when the level lies below the bottom or above the rim.
Result<void> check_level(const Bank& bank, double level_m);

// The level at which the bank was baked; it must have levels.
double baked_level_m(const Bank& bank);

// Fails as check_level() does.
Result<LevelBank> at_level(const Bank& bank, double level_m);

// The modes of the bank itself, which must have levels.
LevelModes as_baked(const Bank& bank);

// Liquid that joins is at rest, so that momentum is kept; liquid that leaves takes its momentum with it. Displacement
// is kept in both cases. The energy never rises.
ModeTransfer transfer(const LevelModes& from, const LevelModes& to);

}  // namespace ringdown::modal
