// Reads the physical groups of the model that is open in gmsh. [worker, within a GmshSession]
#pragma once

#include "engine/mesh/mesh_check.h"

namespace ringdown::mesh {

// Returns the groups of volumes and surfaces for the mesh that check_mesh() made of all elements of gmsh's type
// `element_type`. A group without a name gets its number as name. Only outer faces count. Returns no groups if
// check_mesh() dropped elements, because the model's elements then no longer match.
MeshGroups groups_of_open_model(int element_type, const CheckedMesh& checked);

}  // namespace ringdown::mesh
