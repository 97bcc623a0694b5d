// Chooses a bank's sample points: as few points of the surface as the wanted error of amplitudes allows. [worker]
//
// A strike between sample points is interpolated linearly on the triangle it falls on. Its error has two parts, and
// both are made small here: the triangles are chosen where the shapes bend (mesh/coarsen.h), and the values at the
// points are not those of the finite elements but the ones whose interpolation is nearest to the finite elements over
// the whole surface (least squares). For a wave that has n points to its length, interpolating the exact values errs
// by 3.6 / n^2, the best values by 1.5 / n^2: three percent takes 7 points a wave in place of 11.
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/boundary.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ringdown::bake {

struct PointRequest {
  double shape_error = 0.03;  // that the median of the modes may have. 10/3 of it are allowed to any mode, and to the
                              // rms of all modes in any region of a twentieth of the surface
  std::size_t points = 0;     // so many instead, >= 4, whatever the error; 0: as many as the error takes. All nodes,
                              // with the shapes' own values, if the surface has no more
};

struct SamplePoints {
  mesh::Points positions;                               // P x 3 [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  // positions in `positions`, counter-clockwise from outside
  Eigen::MatrixXd shapes;                               // 3P x M
  Eigen::VectorXd errors;  // M: rms over the surface of what linear interpolation is off, over the mode's own rms
};

// `surface` is boundary_of(mesh), with lengths in units of the body's; `shapes` (3S x M) are at its nodes, in any unit.
// The triangles enclose the body's volume within 1 %. When even all nodes of the surface err by more than was asked
// for, all are taken and the errors tell. Fails when the surface cannot be reduced to request.points, or when cancelled
// (stage "finish").
Result<SamplePoints> choose_points(const mesh::TetMesh& mesh, const mesh::Boundary& surface,
                                   const Eigen::MatrixXd& shapes, const PointRequest& request,
                                   const Progress& progress = {});

}  // namespace ringdown::bake
