// Fractions as people write them: "0.1%", "0.1 %" or "0.001". [any thread]
#pragma once

#include "engine/base/result.h"

#include <string>

namespace ringdown {

// Fails when it is no number, or not finite.
Result<double> parse_fraction(const std::string& text);

// As a percentage: "0.12 %", with two digits that mean something.
std::string as_percent(double fraction);

}  // namespace ringdown
