// Prints ringdown-bake's report of a bake. [main thread]
#pragma once

#include "engine/bake/bake_object.h"

#include <filesystem>

namespace ringdown::cli {

// Prints to stdout: the bank, the modes left out, the time taken, the errors, and how the body was made and repaired. A
// size that is probably a mistake is questioned on stderr.
void print_report(const bake::ObjectRecipe& recipe, const bake::BakedObject& object,
                  const std::filesystem::path& output);

}  // namespace ringdown::cli
