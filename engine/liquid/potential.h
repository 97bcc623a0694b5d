// The potential of a liquid that does not give way, by boundary elements. [worker]
//
// A wall that moves with the normal velocity q makes the liquid flow with a potential P:
//
//   laplace P = 0,     dP/dn = q on the wall (n out of the liquid),     P = 0 on the free surface
//
// The free surface needs no elements: the image of the wall in it moves the opposite way. The integral of the hat
// functions times Green's formula gives the equation W u = (M/2 -+ K') M^-1 f with the engine's hypersingular operator
// W and adjoint double layer K' (radiate/wave_matrix.h at k = 0), f the integrals of hat q, and u the values of P at
// the nodes. W is symmetric and positive, so that one factorization by Cholesky serves all motions.
#pragma once

#include "engine/base/result.h"
#include "engine/liquid/wetted.h"
#include "engine/radiate/panels.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <memory>
#include <utility>

namespace ringdown::liquid {

struct Potential {
  Eigen::MatrixXd nodes;       // V x M, at the panels' nodes
  Eigen::MatrixXd added_mass;  // M x M, symmetric, no eigenvalue below 0: integral of P_i q_j, without the density
  double asymmetry = 0;        // of the added mass before it was made symmetric, relative
};

inline constexpr int kWetNodes = 2000;

// The wall of one liquid, in panels, with the factors of its equation.
class WetPanels {
 public:
  // Makes panels with about `nodes` nodes. Fails when the wall is not closed but for the free surface.
  static Result<WetPanels> of(const Wetted& liquid, int nodes = kWetNodes, int threads = 0);

  // In the frame of the liquid, closed but for the free surface; normals out of what the wall encloses.
  [[nodiscard]] const radiate::Panels& panels() const;

  // Maps values at the panels' nodes to the liquid's samples, N x V.
  [[nodiscard]] const Eigen::SparseMatrix<double, Eigen::RowMajor>& values() const;

  // The potentials of flows, N x M (wetted.h). In a full closed cavity a flow that changes the volume by Q swells or
  // shrinks the liquid alike everywhere: laplace P = Q / V, and the mean of P over the volume is 0. What presses it
  // together is left to its constant mode (wet_modes.h).
  [[nodiscard]] Potential potential_of(const Eigen::MatrixXd& flow) const;

  // The gradient along the wall, at one of the liquid's samples, of potentials given at the nodes: 3 x M.
  [[nodiscard]] Eigen::MatrixXd slope_at(Eigen::Index sample, const Eigen::MatrixXd& nodes) const;

 private:
  struct Parts;
  explicit WetPanels(std::shared_ptr<const Parts> parts) : parts_(std::move(parts)) {}
  std::shared_ptr<const Parts> parts_;
};

}  // namespace ringdown::liquid
