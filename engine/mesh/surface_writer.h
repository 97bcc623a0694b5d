// Surfaces to files. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/triangle_mesh.h"

#include <filesystem>

namespace ringdown::mesh {

// A PLY text file, which every mesh tool reads; coordinates with 9 digits, in metres. Written to another name first,
// then renamed.
Result<void> write_ply(const TriangleMesh& surface, const std::filesystem::path& path);

}  // namespace ringdown::mesh
