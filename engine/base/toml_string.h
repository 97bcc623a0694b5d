// A text as a TOML file has it: in quotes, with what must be escaped escaped. [any thread]
#pragma once

#include <string>
#include <string_view>

namespace ringdown {

std::string toml_string(std::string_view text);

}  // namespace ringdown
