// Physical groups of the model that is open in gmsh. [worker, within a GmshSession]
#pragma once

#include "engine/mesh/mesh_check.h"

namespace ringdown::mesh {

// The named or numbered groups of volumes and surfaces, for the mesh that check_mesh() made of all elements of gmsh's
// type `element_type`; a group without a name is called by its number. Only outer faces count. None where check_mesh()
// dropped elements, because the model's no longer match.
MeshGroups groups_of_open_model(int element_type, const CheckedMesh& checked);

}  // namespace ringdown::mesh
