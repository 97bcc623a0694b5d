// A surface as triangles, as files have it: perhaps with holes, turned inside out, or cutting itself. [any thread]
#pragma once

#include <Eigen/Core>

#include <cstdint>

namespace ringdown::mesh {

using Triangles = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;

struct TriangleMesh {
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> nodes;  // V x 3 [m]
  Triangles triangles;  // T x 3, numbers of nodes; counter-clockwise from outside where it is sound
};

}  // namespace ringdown::mesh
