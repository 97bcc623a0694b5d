// Points all over a solid's skin, with the derivatives needed for a displacement's slopes along the skin. [worker]
#pragma once

#include "engine/mesh/tet_mesh.h"

#include <Eigen/Core>

#include <vector>

namespace ringdown::mesh {

inline constexpr int kPointsPerFace = 9;  // the middles of the nine parts of a triangle whose sides are cut in three

// Every outer face of every element has kPointsPerFace points, face by face in the order of the faces' corners
// (ascending node numbers), so meshes of different order with equal corners have their points in one order. Each point
// represents a share of the area. With F faces of n = (p + 1)(p + 2)/2 nodes each, N = F kPointsPerFace:
struct FacePoints {
  Points positions, normals;           // N x 3 [m]; outward, of length 1
  Points second, third;                // N x 3 [m], derivatives of the position along the sides of FaceFunctions
  Eigen::VectorXd areas;               // N [m^2]
  Indices nodes;                       // F x n, numbers in the mesh
  std::vector<int> opposite;           // F, the element's corner opposite each face
  std::vector<Eigen::Index> elements;  // F, the element of each face
};
FacePoints face_points(const TetMesh& mesh);

// The n shape functions on the face opposite a corner, in the order of FacePoints::nodes: their values at the face's
// points, and their derivatives along the sides from the face's first corner (of kTetFaces) to its second and third.
// All matrices are kPointsPerFace x n.
struct FaceFunctions {
  Eigen::MatrixXd values, along_second, along_third;
};
FaceFunctions face_functions(int order, int opposite);

}  // namespace ringdown::mesh
