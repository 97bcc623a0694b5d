// Mass, centre and inertia of a meshed solid. [any thread]
#pragma once

#include "engine/fem/assembly.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/modal/bank.h"

namespace ringdown::bake {

// From the mesh and its node mass matrix M. Position is interpolated by the same shape functions as
// displacement, so with X the nodes (N x 3) the integrals of rho, rho x and rho x x^T are exactly 1^T M 1,
// 1^T M X and X^T M X, curved elements included (exact for consistent mass). Principal moments ascend; the
// frame is right-handed, and its signs are fixed, so equal meshes give equal frames.
modal::MassProperties mass_properties(const mesh::TetMesh& mesh, const fem::SparseMatrix& node_mass);

}  // namespace ringdown::bake
