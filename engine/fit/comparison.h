// Recordings of a thing held against banks that were baked of its shape: which modes match, what E/rho, Poisson's ratio
// and damping the recordings ask for, and what is left. [worker]
//
//   const std::vector<Mode> heard = merge(modes_of_each_recording);
//   const NuChoice nu = choose_nu(heard, {{0.2, &soft}, {0.25, &middle}, {0.3, &stiff}});
//   bake again with nu.poisson_ratio, calibrate(heard, bank) (recorded_bank.h), and draw
#pragma once

#include "engine/base/result.h"
#include "engine/fit/modes.h"
#include "engine/fit/recorded_bank.h"
#include "engine/modal/bank.h"

#include <span>
#include <vector>

namespace ringdown::fit {

// The modes of several recordings of one thing, by frequency: those that lie within some cents of each other are one,
// with the mean of their frequencies and decays, weighted by their errors. Modes more than kFaint_db below the loudest
// of their recording are left out.
std::vector<Mode> merge(std::span<const std::vector<Mode>> recordings);

inline constexpr double kFaint_db = 40;

struct NuBank {
  double poisson_ratio;
  const modal::Bank* bank;
};

struct NuChoice {
  double poisson_ratio = 0;
  double misfit_cents = 0;  // there: root mean square over the heard modes, an unmatched one counting as the tolerance
  bool told = false;        // false: the modes hardly depend on it, or the best one lies outside of those given
};

// The ratio at which the modes match best: the vertex of the parabola through the best of the banks and its neighbours.
// Banks ascend by their ratio, three at least. Fails where one of them does not match at all.
Result<NuChoice> choose_nu(std::span<const Mode> heard, std::span<const NuBank> banks, const CalibrateOptions& options);

// The modes of a bank that match, in its tuning and damping, as loud as in this recording: what the bank would sound
// like if it were struck as the thing was.
std::vector<Mode> as_recorded(std::span<const Mode> recording, const modal::Bank& bank, const Calibration& calibration,
                              const CalibrateOptions& options);

// The level of a sound's spectrum over log frequency: of each of `points` steps from low to high the largest [dB].
std::vector<double> spectrum_db(std::span<const double> samples, double sample_rate_hz, double low_hz, double high_hz,
                                std::size_t points);

}  // namespace ringdown::fit
