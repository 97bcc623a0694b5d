// The modes of a shape, free of units: what is left of a body's eigenproblem when E, rho and size are divided out.
//
// Count lengths in L, moduli in E and masses in rho L^3; then K phi = lambda M phi of an isotropic solid depends on its
// shape and Poisson's ratio alone, and
//
//   lambda = E / (rho L^2) lambda',      phi = rho^-1/2 L^-3/2 phi'
//
// are exact. So one solution serves every E, rho, damping and size of a body; the cache keeps it (mode_cache.h), and a
// bake always goes through it, so that a cached bank and a fresh one are the same. L is the diagonal of the mesh's
// bounding box.
#pragma once

#include "engine/mesh/tet_mesh.h"
#include "engine/modal/bank.h"

#include <Eigen/Core>

#include <cstdint>

namespace ringdown::bake {

struct BodyUnits {
  double length_m = 1, modulus_pa = 1, density_kg_m3 = 1;

  [[nodiscard]] double lambda() const { return modulus_pa / (density_kg_m3 * length_m * length_m); }
  [[nodiscard]] double shape() const;
  [[nodiscard]] modal::MassProperties mass(const modal::MassProperties& body) const;
};

struct BodyModes {
  Eigen::VectorXd lambda;     // m, ascending; the rigid motions are left out
  Eigen::MatrixXd shapes;     // 3S x m, at the S nodes of mesh::boundary_surface(), in its order
  Eigen::VectorXd residuals;  // m, as in solve::Eigenmodes
  Eigen::VectorXd errors;     // m, estimated relative errors of the frequencies; or empty: none was made
  double complete_to = 0;     // every mode with lambda up to here is in the set: inertia counted `rigid` + m of them
  int rigid = 0;
  std::int64_t unknowns = 0;
  modal::MassProperties mass;  // of density 1
};

// The first modes only, those with lambda up to `top`.
BodyModes up_to(BodyModes modes, double top);

// The diagonal of the bounding box [m]; > 0 for a checked mesh.
double characteristic_length(const mesh::Points& nodes);

}  // namespace ringdown::bake
