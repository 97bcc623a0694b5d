// One body of liquid: the wall that it wets, in a frame of its own. [worker]
//
// The first coordinate of the frame is the depth below the free surface. Points on the surface have the depth 0.
#pragma once

#include "engine/liquid/wet_wall.h"

#include <Eigen/Core>

#include <vector>

namespace ringdown::liquid {

struct Wetted {
  bool outside = false;  // true: the liquid surrounds the wall; false: the wall encloses it
  bool open = true;      // false: a full closed cavity, without a free surface
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  // a point of the frame is turn * point + shift
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  std::vector<Eigen::Index> triangles;  // of the skin, wet at least in part
  mesh::TriangleMesh wall;              // cut at the depth 0; counter-clockwise from outside what it encloses
  std::vector<Eigen::Index> samples;    // N numbers of the skin's samples that are wet
  mesh::Points at, normals;             // N x 3; normals out of the liquid
  Eigen::VectorXd areas;                // N

  [[nodiscard]] double wall_area() const { return areas.sum(); }
};

// The liquid that wets these pieces below a level.
Wetted wetted_by(const WetWall& wall, const std::vector<Piece>& pieces, double level, bool outside);

// The flow of shapes (3S x M at the nodes of the skin) out of the liquid, N x M: integrals over the samples' patches.
Eigen::MatrixXd flow_of(const Wetted& liquid, const Skin& skin, const Eigen::MatrixXd& shapes);

}  // namespace ringdown::liquid
