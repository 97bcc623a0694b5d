// Which figures of a body a list of frequencies determines, and how well: E/rho and any others of which it is known how
// they move the frequencies. [worker]
//
//   Slopes slopes = ...;                                     // of bakes at the figures, and at each a step further
//   const auto found = determine(heard_hz, slopes, options); // change the figures by found->changes, bake again,
//   repeat
//
// To first order ln f = ln f0 + ln(E/rho) / 2 + sum over figures of slope x change. Each baked frequency is compared
// with the nearest heard one within the tolerance, and the changes are those of least squares. Their standard errors
// follow from what is left over: the spread of the frequencies about the best body, which has the errors of the
// measurement, of the mesh and of the shape in it, and is taken to be alike and independent for all modes.
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::fit {

// Frequencies by rank, and how they depend on figures.
struct Slopes {
  std::vector<double> frequency_hz;         // ascending
  std::vector<std::vector<double>> slopes;  // of each figure: d ln f / d figure, for each frequency
};

struct DetermineOptions {
  double tolerance_cents = 30;  // largest deviation of a match after the tuning
  double tuning_cents = 0;      // of the heard frequencies over the baked ones, about
};

struct Determined {
  std::vector<double> changes;       // of ln(E/rho), then of each figure
  std::vector<double> errors;        // standard error of each of these
  std::vector<double> correlations;  // n x n, row by row
  double spread_cents = 0;           // standard deviation of what is left over
  std::size_t matches = 0;

  [[nodiscard]] double correlation(std::size_t a, std::size_t b) const { return correlations[a * changes.size() + b]; }
};

// Fails when fewer frequencies match than there are figures and two more, or when two figures move all frequencies
// alike.
Result<Determined> determine(std::span<const double> heard_hz, const Slopes& slopes, const DetermineOptions& options);

}  // namespace ringdown::fit
