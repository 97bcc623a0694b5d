#include "engine/base/range.h"

#include <cstdio>

namespace ringdown {
namespace {

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

}  // namespace

Result<void> check_range(double value, const Range& range) {
  if (range.holds(value)) return {};
  return fail(ErrorKind::bad_input, text(value) + " is outside " + text(range.low) + " ... " + text(range.high));
}

}  // namespace ringdown
