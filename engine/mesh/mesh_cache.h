// Meshing the same thing only once. [worker, like gmsh_reader.h]
#pragma once

#include "engine/base/content_cache.h"
#include "engine/mesh/gmsh_reader.h"

namespace ringdown::mesh {

// What read_with_gmsh() gives, bit for bit; from the cache when it was made before from a file of the same content with
// the same options by the same version of gmsh. Not kept are meshes of files that may read others or ask their
// surroundings (`Include`, `Merge`, `SystemCall` and the like in a .geo, `*INCLUDE` in an .inp), and failures.
Result<CheckedMesh> read_through_cache(const std::filesystem::path& path, const GmshOptions& options,
                                       const ContentCache& cache);

}  // namespace ringdown::mesh
