// Units of length on the command line. [any thread]
#pragma once

#include <optional>
#include <string>

namespace ringdown::cli {

inline constexpr const char* kUnitHelp =
    "one unit of the file: mm, cm, m, in, or metres such as 0.001 (default: what the file says, else metres)";

// Metres of "mm", "cm", "m", "in" or a positive number.
std::optional<double> parse_unit(const std::string& text);

// For CLI11: empty, or what is wrong.
std::string check_unit(const std::string& text);

}  // namespace ringdown::cli
