// Makes the walls of a body thicker or thinner. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"

#include <string>

namespace ringdown::mesh {

// Stretches the body by `factor` > 0 along the normal of its wall and keeps its size along the wall: the middle of the
// wall stays, both sides move. A rim moves with the wall that ends there. The wall's normal at a place is the shortest
// way through the body there between two sides that face apart; of a compact body, that is its shortest axis. Errors
// contain `name`: elements that would fold, and a body without two such sides. O(E log E), a second for 10,000
// elements.
Result<void> scale_walls(TetMesh& mesh, double factor, const std::string& name);

}  // namespace ringdown::mesh
