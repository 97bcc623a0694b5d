#include "engine/base/range.h"

#include <cmath>
#include <cstdlib>
#include <string_view>

namespace ringdown {
namespace {

std::string short_text(double value) { return formatted("{:g}", value); }

}  // namespace

Result<void> check_range(double value, const Range& range) {
  if (range.holds(value)) return {};
  return fail(ErrorKind::bad_input, "{} is outside {} ... {}", short_text(value), short_text(range.low),
              short_text(range.high));
}

Result<double> parse_fraction(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  std::string_view rest(end);
  while (rest.starts_with(' ')) rest.remove_prefix(1);
  if (end == text.c_str() || !std::isfinite(number) || (!rest.empty() && rest != "%")) {
    return fail(ErrorKind::bad_input, "'" + text + "' is neither a number nor a percentage such as 0.1%");
  }
  return rest.empty() ? number : number / 100;
}

std::string as_percent(double fraction) { return formatted("{:.2g} %", 100 * fraction); }

double to_digits(double value, int digits) {
  return std::strtod(formatted("{:.{}e}", value, digits - 1).c_str(), nullptr);
}

}  // namespace ringdown
