// What a bake says of the mesh. [main thread]
#pragma once

#include "engine/bake/object_file.h"

namespace ringdown::cli {

// How the body was made, what was found and repaired, on stdout; a questionable size, on stderr.
void print_body(const bake::BakedObject& object);

}  // namespace ringdown::cli
