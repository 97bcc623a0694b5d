// The far field of a layer of sources on the surface. [worker]
#pragma once

#include "engine/radiate/panels.h"

#include <Eigen/Core>

#include <complex>
#include <span>
#include <vector>

namespace ringdown::radiate {

// Directions over the sphere with weights that integrate products of two harmonics up to `degree` exactly.
struct Directions {
  int degree = 0;
  mesh::Points units;       // D x 3, unit vectors
  Eigen::VectorXd weights;  // D; add up to 4 pi
};
Directions directions_for(int degree);

// For each direction, the number of the direction that is its mirror image; `image` as in panels.h.
std::vector<Eigen::Index> images_of(const Directions& directions, int image);

// The degree beyond which the radiation of a body of this radius about the origin is negligible. Higher degrees fall
// like (k radius / degree)^degree.
int degree_for(double wavenumber_rad_m, double radius_m);

// The far field F of layers mu (V x M) in the directions, D x M:
//
//   F(d) = 1 / (4 pi) * integral of mu (-ik n.d - i eta) exp(-ik (y - origin).d) dS
// If `panels` are a part of a surface with mirror planes, F is the field of that part alone, without its images.
Eigen::MatrixXcd far_fields(const Panels& panels, const Eigen::Vector3d& origin, double wavenumber_rad_m,
                            const std::vector<double>& coupling, const Directions& directions,
                            const Eigen::MatrixXcd& layers);

// The coefficients of harmonics up to directions.degree, (degree + 1)^2 x M. `units` are the directions in the
// harmonics' frame, which may be rotated.
Eigen::MatrixXcd harmonics_of(const Directions& directions, const mesh::Points& units, const Eigen::MatrixXcd& fields);

}  // namespace ringdown::radiate
