// The lines of a comparison about the figures that it fitted: values, standard errors, correlations, and the constants
// of the material that follow from the weight. [any]
#pragma once

#include "clients/cli/fit/compare_page.h"

#include <string>

namespace ringdown::cli {

// A few lines of text, each ending with a line break.
std::string fitted_figures(const Comparison& comparison);

}  // namespace ringdown::cli
