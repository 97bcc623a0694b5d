// The tables of docs/materials.md, made from the material files. [worker]
#pragma once

#include "engine/base/result.h"

#include <filesystem>
#include <string>

namespace ringdown::bake {

// Two Markdown tables of every material in `folder`: its figures, and their sources. Figures that are our own choice
// are in italics, figures that are yet to be checked carry a question mark (kOurChoice and kToBeChecked of
// material_library.h). Fails with the first file that cannot be read, or when there is none.
Result<std::string> materials_as_markdown(const std::filesystem::path& folder);

}  // namespace ringdown::bake
