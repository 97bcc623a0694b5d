// Texts in quotes: somebody else's text inside our sentences, and strings in TOML files. [any thread]
#pragma once

#include <string>
#include <string_view>

namespace ringdown {

// `text` in single quotes for an error message: unprintable characters become '?', long text is cut.
// Call it qualified: <iomanip> brings std::quoted, which argument-dependent lookup finds too.
std::string quote(std::string_view text);

// `text` as a TOML file has it: in double quotes, with escapes where TOML needs them.
std::string toml_string(std::string_view text);

}  // namespace ringdown
