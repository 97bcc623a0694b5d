// Other figures in an object file, the rest of its text as it was. [any thread]
#pragma once

#include "engine/base/result.h"

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace ringdown::bake {

struct ObjectChanges {
  std::map<std::string, double> parameters;  // of [parameters]; new ones are added
  double mesh_size_m = 0;                    // 0: as it is
  std::filesystem::path geometry;            // as the file says it; empty: as it is
};

// `text`, an object file, with these figures; its name goes, so that it is the new file's. Comments and order stay.
// Fails when it is not an object, or writes what changes in a way that is not understood (one key to a line, parameters
// in a table of their own).
Result<std::string> change_object(std::string_view text, const ObjectChanges& changes);

}  // namespace ringdown::bake
