// Writes values as text: foreign text quoted in messages, and strings and numbers for TOML files. [any thread]
#pragma once

#include "engine/base/vec3.h"

#include <string>
#include <string_view>

namespace ringdown {

// Returns `text` in single quotes for an error message: unprintable characters become '?', long text is cut.
// Call this function qualified: <iomanip> brings std::quoted, which argument-dependent lookup finds too.
std::string quote(std::string_view text);

// Returns `text` as a TOML string: in double quotes, with escapes where TOML needs them.
std::string toml_string(std::string_view text);

// Return the shortest TOML text that reads back as exactly this finite number or [x, y, z].
std::string toml_number(double number);
std::string toml_vector(const Vec3& v);

}  // namespace ringdown
