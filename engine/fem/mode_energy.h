// Strain and kinetic energy of a body's modes, part by part. [worker]
#pragma once

#include "engine/fem/solid.h"
#include "engine/mesh/tet_mesh.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace ringdown::fem {

struct ModeEnergy {
  Eigen::MatrixXd strain;  // parts x m: phi^T K phi
  Eigen::MatrixXd motion;  // parts x m: phi^T M phi
};

// Sums both energies over the elements of each part, by the laws of `solid`, which need not be stable: given the
// imaginary part of the stiffness, the sums are the energies lost in a cycle. `part_of` has a part's number for each
// element; if it is empty, all elements belong to part 0. Shapes are 3N x m. One pass over the elements, on all
// processors.
ModeEnergy mode_energy(const mesh::TetMesh& mesh, const Solid& solid, const std::vector<std::int32_t>& part_of,
                       int parts, const Eigen::Ref<const Eigen::MatrixXd>& shapes);

}  // namespace ringdown::fem
