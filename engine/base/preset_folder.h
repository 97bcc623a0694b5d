// Where presets/ is. [any thread]
#pragma once

#include "engine/base/result.h"

#include <filesystem>

namespace ringdown {

// The environment's RINGDOWN_PRESETS if set; else share/ringdown/presets beside the bin/ that the program
// runs from; else the source tree it was built from. Fails, naming the places, when none of them is a folder.
Result<std::filesystem::path> preset_folder();

}  // namespace ringdown
