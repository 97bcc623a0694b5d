// Elements that lie in each other. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"

#include <string>

namespace ringdown::mesh {

// Fails with one sentence, which says where, when the middle of an element lies inside another: the same body given
// twice, or two that run through each other. Curved elements are passed over; what they enclose is not what their
// corners do. The elements must be positively oriented. O(E log E), a second for a million.
Result<void> check_overlap(const TetMesh& mesh, const std::string& name);

}  // namespace ringdown::mesh
