// Points all over a solid's skin, with what is needed to take a displacement's slopes along it. [worker]
#pragma once

#include "engine/mesh/tet_mesh.h"

#include <Eigen/Core>

#include <vector>

namespace ringdown::mesh {

inline constexpr int kPointsPerFace = 9;  // the middles of the nine parts of a triangle whose sides are cut in three

// Every outer face of every element carries kPointsPerFace points, face by face in the order of the faces' corners
// (ascending node numbers); so a mesh of another order with the same corners has its points in the same order.
// A point stands for a share of the area. With F faces of n = (p + 1)(p + 2)/2 nodes each, N = F kPointsPerFace:
struct FacePoints {
  Points positions, normals;           // N x 3 [m]; outward, of length 1
  Points second, third;                // N x 3 [m], derivatives of the position along the sides of FaceFunctions
  Eigen::VectorXd areas;               // N [m^2]
  Indices nodes;                       // F x n, numbers in the mesh
  std::vector<int> opposite;           // F, the corner of its element that a face lies opposite to
  std::vector<Eigen::Index> elements;  // F
};
FacePoints face_points(const TetMesh& mesh);

// Of the n functions of a face opposite to that corner, in the order of FacePoints::nodes: their values at its points,
// and their derivatives along the sides from its first corner (of kTetFaces) to its second and third. All are
// kPointsPerFace x n.
struct FaceFunctions {
  Eigen::MatrixXd values, along_second, along_third;
};
FaceFunctions face_functions(int order, int opposite);

}  // namespace ringdown::mesh
