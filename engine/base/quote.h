// Values as text: somebody else's text inside our sentences, and strings and numbers in TOML files. [any thread]
#pragma once

#include "engine/base/vec3.h"

#include <string>
#include <string_view>

namespace ringdown {

// `text` in single quotes for an error message: unprintable characters become '?', long text is cut.
// Call it qualified: <iomanip> brings std::quoted, which argument-dependent lookup finds too.
std::string quote(std::string_view text);

// `text` as a TOML file has it: in double quotes, with escapes where TOML needs them.
std::string toml_string(std::string_view text);

// The shortest text that a TOML file reads back as the same finite number, and as the same [x, y, z].
std::string toml_number(double number);
std::string toml_vector(const Vec3& v);

}  // namespace ringdown
