// The potential of a liquid that does not give way, by boundary elements. [worker]
//
// A wall that moves with the normal velocity q makes the liquid flow with a potential P:
//
//   laplace P = 0,     dP/dn = q on the wall (n out of the liquid),     P = 0 on the free surface
//
// The free surface needs no elements: the image of the wall in it moves the opposite way. The integral of the hat
// functions times Green's formula gives the equation W u = (M/2 -+ K') M^-1 f with the engine's hypersingular operator W
// and adjoint double layer K' (radiate/wave_matrix.h at k = 0), f the integrals of hat q, and u the values of P at the
// nodes. W is symmetric and positive, so that one factorization by Cholesky serves all motions.
#pragma once

#include "engine/base/result.h"
#include "engine/liquid/wetted.h"
#include "engine/radiate/panels.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace ringdown::liquid {

struct Potential {
  radiate::Panels panels;                               // V nodes on the wall, in the frame of the liquid
  Eigen::SparseMatrix<double, Eigen::RowMajor> values;  // N x V: from nodes to the liquid's samples
  std::vector<int> triangle_at;                         // N: the panel of each sample
  Eigen::MatrixXd nodes;                                // V x M
  Eigen::MatrixXd added_mass;  // M x M, symmetric, no eigenvalue below 0: integral of P_i q_j, without the density
  double asymmetry = 0;        // of the added mass before it was made symmetric, relative

  // The gradient of the potentials along the wall at a sample, 3 x M.
  [[nodiscard]] Eigen::MatrixXd slope_at(Eigen::Index sample) const;
};

inline constexpr int kWetNodes = 2000;

// The potentials of flows N x M (wetted.h), on about `nodes` nodes. In a closed cavity each flow counts without its
// mean. Fails when the wall is not closed but for the free surface.
Result<Potential> potential_of(const Wetted& liquid, const Eigen::MatrixXd& flow, int nodes = kWetNodes,
                               int threads = 0);

}  // namespace ringdown::liquid
