// Values of parameters as people read and type them: "0.250 x", "200 Hz", "C4", "on", "mug". One way for all formats.
// [any thread but audio]
#pragma once

#include "clients/plugin/parameters.h"

#include <optional>
#include <string>
#include <string_view>

namespace ringdown::plugin {

// Returns the value's name, if it has one, or else its number and unit. Continuous values have three significant
// digits. Values out of range are shown as the nearest value in range.
std::string text_of(std::size_t parameter, double value);

// Returns the value's name or number without the unit, for hosts that add the unit themselves.
std::string number_of(std::size_t parameter, double value);

// Returns the value that a text means: a name in upper or lower case, a key's name or number, or a number with or
// without its unit. The value lies in the parameter's range. Nothing if the text means none.
std::optional<double> value_of(std::size_t parameter, std::string_view text);

}  // namespace ringdown::plugin
