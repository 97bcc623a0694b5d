// Recordings of a thing held against banks that were baked of its shape: which modes match, what E/rho, Poisson's ratio
// and damping the recordings ask for, and what is left. [worker]
//
//   const std::vector<Mode> heard = merge(modes_of_each_recording);
//   const NuChoice nu = choose_nu(heard, banks, options);  // of three bakes with different ratios
//   bake again with nu.poisson_ratio, calibrate(heard, bank, {.around_cents = nu.tuning_cents}) (recorded_bank.h), draw
#pragma once

#include "engine/fit/modes.h"
#include "engine/fit/recorded_bank.h"
#include "engine/modal/bank.h"

#include <span>
#include <vector>

namespace ringdown::fit {

// The modes of several recordings of one thing, by frequency: of different recordings, those within some cents are one,
// with the mean of their frequencies and decays, weighted by their errors, and the largest amplitude. Modes more than
// kFaint_db below the loudest of their recording are left out, and so are a mode's companions: what a room adds beside
// it, within kCompanion_cents, much weaker and shorter.
std::vector<Mode> merge(std::span<const std::vector<Mode>> recordings);

inline constexpr double kFaint_db = 40;
inline constexpr double kCompanion_cents = 60;

struct NuBank {
  double poisson_ratio;
  const modal::Bank* bank;
};

struct NuChoice {
  double poisson_ratio = 0;
  double tuning_cents = 0;  // the recordings over the bank at that ratio
  // Root of the mean square over the heard modes and a quarter of that over the baked ones that could be heard; one
  // without a match counts as the tolerance.
  double misfit_cents = 0;
  bool told = false;  // false: the modes hardly depend on it, or the best one lies at an end of what was searched
};

// Searches Poisson's ratio from the first bank's to the last one's, and the tuning, for the best match of all heard
// modes. In between, each frequency of the banks, by its rank, is a parabola in the ratio. `banks`: three of one shape,
// ascending.
NuChoice choose_nu(std::span<const Mode> heard, std::span<const NuBank, 3> banks, const CalibrateOptions& options);

// The modes of a bank that match, in its tuning and damping, as loud as in this recording: what the bank would sound
// like if it were struck as the thing was.
std::vector<Mode> as_recorded(std::span<const Mode> recording, const modal::Bank& bank, const Calibration& calibration,
                              const CalibrateOptions& options);

// The level of a sound's spectrum over log frequency: of each of `points` steps from low to high the largest [dB].
std::vector<double> spectrum_db(std::span<const double> samples, double sample_rate_hz, double low_hz, double high_hz,
                                std::size_t points);

}  // namespace ringdown::fit
