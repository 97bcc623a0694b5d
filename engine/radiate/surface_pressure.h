// The pressure of a layer of sources at the surface itself. [worker]
#pragma once

#include "engine/radiate/panels.h"

#include <Eigen/Core>

#include <complex>
#include <span>
#include <vector>

namespace ringdown::radiate {

// Keeps references to all it is made of.
class SurfacePressure {
 public:
  // Layers (V x M) of one class. `images` are the part and its mirror images in their order (panels.h); without mirror
  // planes the part alone.
  SurfacePressure(std::span<const Panels> images, int image_class, double wavenumber_rad_m,
                  const std::vector<double>& coupling, const Eigen::MatrixXcd& layers);

  // P just outside of the middle of a triangle of the part: mu/2 + D mu - i S (eta mu). Integrals are sums over the
  // middles of sides; those of near triangles have an exact static part. May be called by several threads at once.
  [[nodiscard]] Eigen::RowVectorXcd at(int triangle) const;

 private:
  void add_sides(const Panels& panels, const Eigen::Vector3d& x, double sign, Eigen::RowVectorXcd& sum) const;
  void mend_near(const Panels& panels, int itself, const Eigen::Vector3d& x, double sign,
                 Eigen::RowVectorXcd& sum) const;

  const std::span<const Panels> images_;
  const int image_class_;
  const double k_;
  const std::vector<double>& coupling_;
  const Eigen::MatrixXcd& layers_;
  Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> dipoles_, simple_;  // of sides
};

}  // namespace ringdown::radiate
