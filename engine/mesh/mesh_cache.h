// Making the same body only once. [worker]
#pragma once

#include "engine/base/content_cache.h"
#include "engine/mesh/body_reader.h"

#include <functional>

namespace ringdown::mesh {

// What make() gives, bit for bit; from the cache when it was made before from a file of the same content with the same
// options by the same versions of this program's meshing and of gmsh. Not kept are bodies of files that may read others
// or ask their surroundings (`Include`, `Merge`, `SystemCall` and the like in a .geo or .bdf, a .gltf, TetGen's two),
// and failures.
Result<Body> make_through_cache(const std::filesystem::path& path, const GmshOptions& options,
                                const ContentCache& cache, const std::function<Result<Body>()>& make);

}  // namespace ringdown::mesh
