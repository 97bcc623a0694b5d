// Prints the report of `ringdown fit`. [any]
#pragma once

#include "engine/fit/modes.h"
#include "engine/fit/recorded_bank.h"
#include "engine/fit/settle.h"
#include "engine/modal/bank.h"

#include <string>

namespace ringdown::cli {

// Prints one paragraph about the recording and a row for each mode.
void print_fit(const std::string& name, const fit::Fit& fit);

// Prints a description of the burst and the distance between the kept sound and the recording; and on stderr a warning
// if the modes explain little of it.
void print_kept(const std::string& name, const fit::Fit& fit, const fit::Kept& kept);

// Prints a row for each matched mode and the fitted loss factors.
void print_calibration(const fit::Fit& fit, const modal::Bank& bank, const fit::Calibration& calibration);

}  // namespace ringdown::cli
