// The quadratic part of Green's strain: the strains that bending causes inside a body. [worker]
//
// A displacement v stretches the body by eps(v) + E2(v, v), with the linear strain eps and
//
//   E2_ij(a, b) = 1/4 sum over k of  da_k/dx_i db_k/dx_j + db_k/dx_i da_k/dx_j                  (symmetric in a, b)
//
// (Green's strain; Landau & Lifshitz, Theory of Elasticity, section 1). For modes phi_1 .. phi_M and a *mixture*, a
// symmetric M x M matrix R, E2(R) = sum R_mn E2(phi_m, phi_n) is a field of strains. Let <a, b> be the integral of a :
// C b over the body. This class computes the nodal forces of such a field, and its products with the fields of all
// pairs.
//
// No field is ever stored for all pairs. Inside an element E2(R) is 1/2 sum over nodes a, b of
// P_ab grad N_a grad N_b^T, P = sum R_mn phi_m phi_n^T; and the products of a stress with all pairs are
// 1/2 phi_m^T G phi_n, where G is the stress's geometric stiffness (Bathe, Finite Element Procedures, section 6.3).
#pragma once

#include "engine/fem/elastic.h"
#include "engine/mesh/tet_mesh.h"

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace ringdown::fem {

class QuadraticStrain {
 public:
  // `shapes` is 3N x M, unknown 3 n + i as in assembly.h. `mesh` must live longer. Memory: 8 * 3 N M bytes for a copy
  // of the shapes, and as much again for each thread; about 5 kB for each curved element. threads = 0 uses one thread
  // per processor, at most 4.
  QuadraticStrain(const mesh::TetMesh& mesh, const Elastic& elastic, const Eigen::MatrixXd& shapes, int threads = 0);

  // The nodal forces of E2(R): f with f . u = <E2(R), eps(u)> for every displacement u. 3N numbers.
  [[nodiscard]] Eigen::VectorXd force(const Eigen::MatrixXd& mixture) const;

  // <E2(phi_m, phi_n), E2(R) - eps(u)> for all pairs: M x M, symmetric.
  [[nodiscard]] Eigen::MatrixXd products(const Eigen::MatrixXd& mixture, const Eigen::VectorXd& u) const;

  // The nodal forces that force() leaves out for mode m: those of the mode's own linear stress once the mode has turned
  // the body, that is the u-derivative of <eps(phi_m), 2 E2(phi_m, u)>. Small where modes bend and do not stretch. 3N
  // numbers.
  [[nodiscard]] Eigen::VectorXd carried_force(Eigen::Index mode) const;

 private:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  struct Place {              // a quadrature point in an element
    Eigen::Matrix3d inverse;  // inverse Jacobian
    double volume = 0;        // volume of a straight element with that Jacobian [m^3]
  };
  struct Batch;

  [[nodiscard]] const Place& place(Eigen::Index element, std::size_t point) const;
  [[nodiscard]] Eigen::Matrix3d weighted_stress(const Eigen::Matrix3d& strain, std::size_t point, double volume) const;
  void gather(const Rows& from, Eigen::Index element, Rows& to) const;
  void load(const Rows& mixed, Eigen::Index first, Eigen::Index count, Batch& batch) const;
  [[nodiscard]] Eigen::MatrixXd reference_slopes(const Eigen::VectorXd& u, Eigen::Index element) const;
  void add_force(const Eigen::MatrixXd& stresses, Eigen::Index element, Eigen::VectorXd& force) const;
  void for_batches(const std::function<void(int, Eigen::Index, Eigen::Index)>& work) const;

  const mesh::TetMesh& mesh_;
  Elastic elastic_;
  int threads_;
  Eigen::Index modes_;
  Rows shapes_;                  // 3N x M
  Eigen::MatrixXd gradients_;    // 3 points x n: gradients of the reference element's functions
  Eigen::MatrixXd from_pairs_;   // 6 points x n (n + 1) / 2: maps the lower triangle of P to the reference element's E2
  std::vector<double> weights_;  // quadrature weights
  std::vector<std::vector<Place>> places_;  // one list per element; a straight one has one entry
};

}  // namespace ringdown::fem
