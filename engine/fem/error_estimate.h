// How far the frequencies of a mesh are from those of the body it stands for. [worker]
//
// Finite elements of order p miss what only functions of higher degree can follow; frequencies come out too high by
// that. The estimate asks how much a mode's energy would fall if the mesh had the functions of degree p + 1, too: a
// hierarchical surplus, by the mode's residual on the new functions alone (Zienkiewicz, de S. R. Gago & Kelly,
// Computers & Structures 16, 1983; Bank & Smith, SIAM J. Numer. Anal. 30, 1993). docs/how/accuracy.md derives it and
// compares it with true errors: mostly between 1 and 4 times the truth on blocks, bars, plates and a sphere.
//
// The estimate does not see three errors: what a mesh's elements, curved as they are, leave of the shape of the body
// (docs/how/accuracy.md says how much that is), the error of the material's constants, and that of a lumped mass, which
// pulls the other way.
#pragma once

#include "engine/base/result.h"
#include "engine/fem/holding.h"
#include "engine/fem/solid.h"
#include "engine/mesh/tet_mesh.h"

#include <Eigen/Core>

namespace ringdown::fem {

// An error this large is not told from a larger one.
inline constexpr double kMaxFrequencyError = 10;

// Relative errors of the frequencies, m numbers from 0 to kMaxFrequencyError: 0.001 says that the true frequency is
// about 0.1 % lower. The m modes are elastic ones (lambda > 0) of `mesh`: lambda and the columns of shapes, 3N x m with
// unit modal mass, unknown 3 n + i as in assembly.h. threads = 0: as many as there are processors; the result is the
// same for any number of them. Cost on one core: about 0.1 ms for each element and 2 us for each element and mode
// (order 3); memory: 4 (3w)^2 bytes for each element, 8 KB for order 3. Fails when memory runs out.
//
// `holding` is what holds the body (holding.h): finer elements would be clamped, sprung and loaded in the same places.
Result<Eigen::VectorXd> frequency_errors(const mesh::TetMesh& mesh, const Solid& solid,
                                         const Eigen::Ref<const Eigen::VectorXd>& lambda,
                                         const Eigen::Ref<const Eigen::MatrixXd>& shapes, int threads = 0,
                                         const Holding& holding = {});

}  // namespace ringdown::fem
