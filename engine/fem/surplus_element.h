// What the functions of degree p + 1 (mesh/surplus_basis.h) meet in one element of order p. Private to the estimate of
// errors. [any thread]
//
// V are the element's shape functions of order p, n of them, W the w functions of degree p + 1. Displacements are
// ordered by component: row i w + a (or i n + a) is function a along axis i.
#pragma once

#include "engine/fem/elastic.h"
#include "engine/mesh/tet_shape.h"

#include <Eigen/Core>

#include <vector>

namespace ringdown::fem {

struct SurplusMatrices {
  Eigen::MatrixXd coupling;  // 3w x 3n: K between W and V
  Eigen::MatrixXd mass;      // w x n: M between W and V, the same along every axis
  Eigen::MatrixXf energy;    // 3w x 3w: what W costs when the element may relax, see error_estimate.cpp
};

class SurplusElement {
 public:
  SurplusElement(int order, const Elastic& elastic);

  // `nodes` in the order of SurplusSpace::nodes; the element may be inside out.
  [[nodiscard]] SurplusMatrices operator()(const mesh::ElementNodes& nodes) const;

  [[nodiscard]] int functions() const { return w_; }
  [[nodiscard]] int nodes() const { return n_; }

 private:
  // Of all functions, W's first: the integrals of d_k N_a d_l N_b at row k (w + n) + a, column l (w + n) + b. Fills
  // `mass` without the density.
  Eigen::MatrixXd gradient_products(const mesh::ElementNodes& nodes, Eigen::MatrixXd& mass) const;
  Eigen::MatrixXf relaxed(const Eigen::MatrixXd& stiffness, const mesh::ElementNodes& nodes) const;

  int w_, n_;
  Elastic elastic_;
  Eigen::VectorXd weights_;                         // of the points, summing to 1/6
  std::vector<mesh::ReferenceGradient> gradients_;  // at each point, w + n rows
  Eigen::MatrixXd surplus_, shapes_;                // w and n rows, a column for each point
  Eigen::MatrixXd straight_products_;               // gradient_products() of the reference element
  Eigen::MatrixXd straight_mass_;
};

}  // namespace ringdown::fem
