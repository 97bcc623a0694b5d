// The tables [grain], [[part]], [[support]] and [[mass]] of an object file (object_file.h). [worker]
#pragma once

#include "engine/bake/makeup.h"
#include "engine/base/toml_table.h"

namespace ringdown::bake {

// Materials of parts have their names only.
void read_makeup(TomlTable& file, Makeup& makeup);

}  // namespace ringdown::bake
