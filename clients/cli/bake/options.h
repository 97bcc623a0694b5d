// Command-line options that ringdown-bake, ringdown-check and ringdown-tune share. [main]
#pragma once

#include "engine/base/result.h"

#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::cli {

// Metres of "mm", "cm", "m", "in" or a positive number.
std::optional<double> parse_unit(const std::string& text);

// A check for CLI11: returns an empty text, or what is wrong.
std::string check_unit(const std::string& text);

// A finite number, with nothing before or after it.
std::optional<double> parse_number(const std::string& text);

// Adds settings such as "length=300" to `values`. Fails when a setting is not NAME=NUMBER; `option` stands in the
// sentence.
Result<void> read_settings(const std::string& option, const std::vector<std::string>& settings,
                           std::map<std::string, double>& values);

}  // namespace ringdown::cli
