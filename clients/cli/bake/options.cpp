#include "clients/cli/bake/options.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace ringdown::cli {

std::optional<double> parse_unit(const std::string& text) {
  if (text == "mm") return 0.001;
  if (text == "cm") return 0.01;
  if (text == "m") return 1;
  if (text == "in") return 0.0254;
  const std::optional<double> metres = parse_number(text);
  return metres && *metres > 0 ? metres : std::nullopt;
}

std::string check_unit(const std::string& text) {
  return parse_unit(text) ? "" : "a unit is mm, cm, m, in or a positive number of metres, not '" + text + "'";
}

std::optional<double> parse_number(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value)) return std::nullopt;
  return value;
}

Result<void> read_settings(const std::string& option, const std::vector<std::string>& settings,
                           std::map<std::string, double>& values) {
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    const auto value = equals == std::string::npos ? std::nullopt : parse_number(setting.substr(equals + 1));
    if (!value || equals == 0) {
      return fail(ErrorKind::bad_input, "{} takes NAME=NUMBER, not '{}'", option, setting);
    }
    values[setting.substr(0, equals)] = *value;
  }
  return {};
}

}  // namespace ringdown::cli
