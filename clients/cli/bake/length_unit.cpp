#include "clients/cli/bake/length_unit.h"

#include <cmath>
#include <cstdlib>

namespace ringdown::cli {

std::optional<double> parse_unit(const std::string& text) {
  if (text == "mm") return 0.001;
  if (text == "cm") return 0.01;
  if (text == "m") return 1;
  if (text == "in") return 0.0254;
  char* end = nullptr;
  const double metres = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(metres > 0) || !std::isfinite(metres)) return std::nullopt;
  return metres;
}

std::string check_unit(const std::string& text) {
  return parse_unit(text) ? "" : "a unit is mm, cm, m, in or a positive number of metres, not '" + text + "'";
}

}  // namespace ringdown::cli
