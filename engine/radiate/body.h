// A vibrating body, as input of the solver: a closed surface and the flow of air of each mode. [any thread]
#pragma once

#include "engine/mesh/tet_mesh.h"
#include "engine/mesh/triangle_mesh.h"

#include <Eigen/Core>

#include <vector>

namespace ringdown::radiate {

// The flow of air that M modes cause at N places of the surface.
struct FlowSamples {
  mesh::Points positions;  // N x 3 [m]
  mesh::Points normals;    // N x 3, outward unit vectors; tell the two sides of a thin wall apart
  Eigen::VectorXd areas;   // N [m^2]: area of each sample's patch
  Eigen::MatrixXf
      flow;  // N x M [m^2 kg^-1/2]: integral of phi.n over the patch; for a small patch phi.n times its area
};

// The flow of shapes that are linear on flat triangles; displacement[m] is V x 3 [kg^-1/2] at the nodes. Takes three
// samples per triangle, exact in the integral. Triangles with sides longer than `max_edge_m` are divided first (0: none
// is).
FlowSamples flow_of(const mesh::TriangleMesh& surface, const std::vector<Eigen::MatrixX3d>& displacement,
                    double max_edge_m = 0);

struct Body {
  mesh::TriangleMesh surface;        // closed, possibly in several pieces; finer than the waves it radiates
  FlowSamples flow;                  // flow of M modes; samples about as dense as the surface's triangles
  std::vector<double> frequency_hz;  // M
};

}  // namespace ringdown::radiate
