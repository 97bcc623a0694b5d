// The cubic spline between a bank's levels of a liquid. [any thread]
#pragma once

#include <vector>

namespace ringdown::modal {

// Returns the share that each level has in the value of the spline at `x`. The spline has no slope at the first level,
// where the liquid begins, and one polynomial for the last two stretches. `at` is ascending, of 3 levels or more.
std::vector<double> spline_shares(const std::vector<double>& at, double x);

}  // namespace ringdown::modal
