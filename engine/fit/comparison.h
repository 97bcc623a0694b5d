// Compares recordings of an object with banks baked from its shape: finds the modes that match, and the E/rho,
// Poisson's ratio and damping that fit the recordings, and shows the remaining differences. [worker]
//
//   const std::vector<Mode> heard = merge(modes_of_each_recording);
//   const NuChoice nu = choose_nu(heard, curves, options);  // of three bakes with different ratios (nu_curves.h)
//   bake again with nu.poisson_ratio, calibrate(heard, bank, {.around_cents = nu.tuning_cents}) (recorded_bank.h), draw
#pragma once

#include "engine/fit/identification.h"
#include "engine/fit/modes.h"
#include "engine/fit/nu_curves.h"
#include "engine/fit/recorded_bank.h"
#include "engine/modal/bank.h"

#include <span>
#include <vector>

namespace ringdown::fit {

// Merges the modes of several recordings of one object, sorted by frequency. Modes of different recordings within a few
// cents become one mode, with the mean of their frequencies and decays, weighted by their errors, and the largest
// amplitude. Modes more than kFaint_db below the loudest of their recording are left out. So are companions, which a
// room adds within kCompanion_cents of a mode, much weaker and shorter than the mode.
std::vector<Mode> merge(std::span<const std::vector<Mode>> recordings);

inline constexpr double kFaint_db = 40;
inline constexpr double kCompanion_cents = 60;

struct NuChoice {
  double poisson_ratio = 0;
  double tuning_cents = 0;  // tuning of the recordings over the bank at that ratio
  // Square root of the mean square deviation over the heard modes plus a quarter of that over the baked modes that
  // could be heard. A mode without a match counts as the tolerance.
  double misfit_cents = 0;
  bool told = false;  // false: the modes hardly depend on the ratio, or the best one lies at an end of the range
};

// Searches Poisson's ratio, over the curves, and the tuning for the best match of all heard modes.
NuChoice choose_nu(std::span<const Mode> heard, const NuCurves& curves, const CalibrateOptions& options);

struct FigureChoice {
  std::vector<double> changes;  // of each figure
  double tuning_cents = 0;      // tuning of the recordings over the frequencies at these figures
};

// Searches all figures of `slopes`, each up to `reach` to either side, and the tuning for the best match of all heard
// modes, on a grid. Where several are equally good, the smallest change wins. Time grows as a power of the number of
// figures; more than three are searched coarsely.
FigureChoice search_figures(std::span<const Mode> heard, const Slopes& slopes, std::span<const double> reach,
                            const CalibrateOptions& options);

// Chance finds matches, too: this is how many it finds in lists of modes that are not the object's.
struct Chance {
  double matches = 0;  // mean over the lists
  double share = 0;    // of the lists that match as many modes, or more
};

// Shifts each heard mode by a random 50 to 300 cents up or down, searches ratio and tuning for each such list as
// choose_nu() does, in coarser steps, and counts the modes that then lie within the tolerance of a baked mode of their
// own. `matches` is what the heard modes have. The lists are the same in every call.
Chance chance_of(std::span<const Mode> heard, const NuCurves& curves, const CalibrateOptions& options,
                 std::size_t matches);

// The bank's matching modes, with the calibrated tuning and damping, as loud as in the recording. They sound like the
// bank struck in the same way as the object.
std::vector<Mode> as_recorded(std::span<const Mode> recording, const modal::Bank& bank, const Calibration& calibration,
                              const CalibrateOptions& options);

// The level of a sound's spectrum over log frequency [dB]: the largest value in each of `points` steps from low to
// high.
std::vector<double> spectrum_db(std::span<const double> samples, double sample_rate_hz, double low_hz, double high_hz,
                                std::size_t points);

}  // namespace ringdown::fit
