// Estimates how far the frequencies of a mesh are from those of the body that the mesh approximates. [worker]
//
// Finite elements of order p cannot represent functions of higher degree, which makes the frequencies too high. The
// estimate asks how much a mode's energy would fall if the mesh also had the functions of degree p + 1. It is a
// hierarchical surplus, found from the mode's residual on the new functions alone (Zienkiewicz, de S. R. Gago & Kelly,
// Computers & Structures 16, 1983; Bank & Smith, SIAM J. Numer. Anal. 30, 1993). docs/how/accuracy.md derives the
// estimate and compares it with true errors: it is mostly between 1 and 4 times the truth on blocks, bars, plates and a
// sphere.
//
// The estimate does not see three errors: the difference in shape between the body and even curved elements
// (docs/how/accuracy.md has its size), the error of the material's constants, and the error of a lumped mass, which has
// the opposite sign.
#pragma once

#include "engine/base/result.h"
#include "engine/fem/holding.h"
#include "engine/fem/solid.h"
#include "engine/mesh/tet_mesh.h"

#include <Eigen/Core>

namespace ringdown::fem {

// Larger errors are reported as this value.
inline constexpr double kMaxFrequencyError = 10;

// Relative errors of the frequencies, m numbers from 0 to kMaxFrequencyError: 0.001 says that the true frequency is
// about 0.1 % lower. The m modes must be elastic modes (lambda > 0) of `mesh`: lambda and the columns of shapes, 3N x m
// with unit modal mass, unknown 3 n + i as in assembly.h. threads = 0 uses one thread per processor; the number of
// threads does not change the result. Cost on one core: about 0.1 ms for each element and 2 us for each element and
// mode (order 3); memory: 4 (3w)^2 bytes for each element, 8 KB for order 3. Fails when memory runs out.
//
// `holding` has the supports of the body (holding.h): the new functions are clamped, sprung and loaded in the same
// places as the mesh.
Result<Eigen::VectorXd> frequency_errors(const mesh::TetMesh& mesh, const Solid& solid,
                                         const Eigen::Ref<const Eigen::VectorXd>& lambda,
                                         const Eigen::Ref<const Eigen::MatrixXd>& shapes, int threads = 0,
                                         const Holding& holding = {});

}  // namespace ringdown::fem
