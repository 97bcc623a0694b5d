// Closed ranges of numbers, fractions that people write, such as "0.1%", and rounding to digits. [any thread]
#pragma once

#include "engine/base/result.h"

#include <string>

namespace ringdown {

struct Range {
  double low = 0, high = 0;
  [[nodiscard]] bool holds(double value) const { return value >= low && value <= high; }  // false for NaN
};

// Fails with "9 is outside -1 ... 1" when the value is outside.
Result<void> check_range(double value, const Range& range);

// Reads "0.1%", "0.1 %" or "0.001". Fails when the text is not a number, or the number is not finite.
Result<double> parse_fraction(const std::string& text);

// Writes a fraction as a percentage with two significant digits: "0.12 %".
std::string as_percent(double fraction);

// Rounds to a number of significant digits, so that a file has no digits without a meaning.
double to_digits(double value, int digits);

}  // namespace ringdown
