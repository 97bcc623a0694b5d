// Stress of displacement fields on the skin of a solid: where, and how much, its modes stretch it. [worker]
//
// The skin is free of forces, so stress there is plane: three components along two perpendicular tangents. They follow
// from the displacements of the skin alone, by the law of the solid with no stress along the normal:
//
//   isotropic    s11 = E/(1 - nu^2) (e11 + nu e22),   s12 = G g12
//   anisotropic  s = (C_pp - C_pn C_nn^-1 C_np) e     with C in the axes of tangents and normal, p = (11, 22, 12),
//                                                     n = (33, 23, 13) (Lekhnitskii, Anisotropic Plates, section 1)
//
// Stress is linear in the displacement, so components of several fields may be added, and the principal stresses of the
// sum follow. Where a body is held by forces on its skin, or where another body is bonded to it, the assumption fails.
//
// If `shapes` are mass-normalised modes, stress of a unit coordinate is in Pa / (kg^1/2 m), and it scales as
// stiffness / (density^1/2 size^5/2).
#pragma once

#include "engine/fem/solid.h"
#include "engine/mesh/tet_mesh.h"

#include <Eigen/Core>

namespace ringdown::fem {

struct SurfaceStress {
  mesh::Points positions, normals;  // P x 3 [m]; outward, of length 1
  mesh::Points first, second;       // P x 3, tangents of length 1; first x second = normal
  Eigen::MatrixXd components;       // 3P x m: rows 3p, 3p + 1, 3p + 2 are s11, s22, s12 at point p
  // m: the largest magnitude of a principal stress at any point of all faces that was looked at. In one of a mode's
  // phases this stress is tensile.
  Eigen::VectorXd largest;
};

inline constexpr Eigen::Index kStressPoints = 300;

// Computes the stress of `shapes`, 3N x m, on a mesh of any order, curved or not. Candidates are the nine points inside
// each outer face (mesh::face_points()); `largest` is taken over all of them. At most `points` >= 1 of them are kept:
// where each of the first points / 2 modes has its largest stress, and then each farthest from those that are kept
// already (Gonzalez, Theor. Comput. Sci. 38, 1985), so that they are spread over the skin. In a struck pane, 300 points
// had the largest stress that 3,000 had farther than 3 cm from the blow; under the blow they had 17 % less.
//
// Cost for F faces with n nodes each, on one thread: 162 F n m operations for stresses and 80 F `points` for the
// choice; about 0.5 s for 5,000 faces of order 3 and 100 modes.
SurfaceStress surface_stress(const mesh::TetMesh& mesh, const Solid& solid,
                             const Eigen::Ref<const Eigen::MatrixXd>& shapes, Eigen::Index points = kStressPoints);

// The law of plane stress in a frame: maps the strains e11, e22 and 2 e12 along its first two axes to s11, s22, s12.
// The columns of `frame` are orthonormal; the third is the normal.
Eigen::Matrix3d plane_stress_law(const Law& law, const Eigen::Matrix3d& frame);

// The larger and the smaller principal stress.
struct PrincipalStress {
  double larger = 0, smaller = 0;
};
PrincipalStress principal_stress(double s11, double s22, double s12);

}  // namespace ringdown::fem
