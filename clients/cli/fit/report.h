// What `ringdown fit` prints. [any]
#pragma once

#include "engine/fit/calibrate.h"
#include "engine/fit/modes.h"
#include "engine/modal/bank.h"

#include <string>

namespace ringdown::cli {

// One paragraph about the recording, and a row for each mode.
void print_fit(const std::string& name, const fit::Fit& fit);

// One row for each matched mode, and what came of them.
void print_calibration(const fit::Fit& fit, const modal::Bank& bank, const fit::Calibration& calibration);

}  // namespace ringdown::cli
