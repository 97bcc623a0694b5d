// The surface of a vessel in triangles that are small where the air before the wall is narrow. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/triangle_mesh.h"
#include "engine/radiate/skin.h"

namespace ringdown::cavity {

// Tiles for radiate::skin_of(), with about `nodes` nodes. Sides are a fixed share of the opening: the distance from the
// wall straight through the air to the next wall, at most half the body's radius, and at most the opening at any other
// place plus the way to it. Fails as radiate::panels_of() does.
Result<mesh::TriangleMesh> graded_tiles(const radiate::Original& original, int nodes);

}  // namespace ringdown::cavity
