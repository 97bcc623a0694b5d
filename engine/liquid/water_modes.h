// The modes of a liquid between walls at rest, under a free surface. [worker]
//
//   -laplace psi = kappa^2 psi,   dpsi/dn = 0 on the wall,   psi = 0 on the free surface,   integral of psi^2 = 1
//
// They are found by Ritz's method with polynomials: products of Chebyshev's polynomials times the depth, which is 0 on
// the surface. Walls at rest are the natural condition of the method, so the polynomials need not know the wall, and no
// mesh of the liquid is made. The integrals over the liquid are sums over columns between wall and surface, with
// Gauss's rule in each. Wavenumbers come out too high, never too low; those with less than about two waves across the
// liquid are good to 0.1 %.
#pragma once

#include "engine/liquid/wetted.h"
#include "engine/radiate/panels.h"

#include <Eigen/Core>

#include <array>

namespace ringdown::liquid {

class WaterModes {
 public:
  // `panels` are on the wall of the liquid, which they enclose (Potential::panels).
  WaterModes(const Wetted& liquid, const radiate::Panels& panels);

  [[nodiscard]] Eigen::Index count() const { return wavenumbers_.size(); }
  [[nodiscard]] const Eigen::VectorXd& wavenumbers() const {
    return wavenumbers_;
  }  // J, ascending; that of a closed
     // cavity's constant is 0

  // Values at places in the frame of the liquid, N x J, and the derivatives along its three axes.
  [[nodiscard]] Eigen::MatrixXd values(const mesh::Points& places) const;
  [[nodiscard]] std::array<Eigen::MatrixXd, 3> slopes(const mesh::Points& places) const;

 private:
  struct Terms {
    Eigen::MatrixXd values;
    std::array<Eigen::MatrixXd, 3> slopes;
  };
  [[nodiscard]] Terms terms_at(const mesh::Points& places) const;

  bool open_;
  Eigen::RowVector3d low_, size_;  // of the box around the liquid
  Eigen::MatrixXd mixing_;         // polynomials x J
  Eigen::VectorXd wavenumbers_;
};

}  // namespace ringdown::liquid
