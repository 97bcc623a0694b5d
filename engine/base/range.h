// Closed ranges of numbers, and the words for a number outside. [any thread]
#pragma once

#include "engine/base/result.h"

namespace ringdown {

struct Range {
  double low = 0, high = 0;
  [[nodiscard]] bool holds(double value) const { return value >= low && value <= high; }  // false for NaN
};

// "9 is outside -1 ... 1", or nothing when it is inside.
Result<void> check_range(double value, const Range& range);

}  // namespace ringdown
