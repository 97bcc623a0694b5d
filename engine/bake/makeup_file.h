// The tables [grain], [[part]], [[support]] and [[mass]] of an object file (object_file.h). [worker]
#pragma once

#include "engine/bake/makeup.h"
#include "engine/base/result.h"
#include "engine/base/toml_table.h"

#include <string>

namespace ringdown::bake {

// Materials of parts have their names only.
void read_makeup(TomlTable& file, Makeup& makeup);

// A [[support]] in one line, as "kind = \"clamped\", plane = [0, 0, 0, 1, 0, 0]".
Result<Support> parse_support(const std::string& text);

}  // namespace ringdown::bake
