#pragma once

#include "engine/fem/elastic.h"
#include "engine/mesh/tet_mesh.h"

#include <Eigen/Core>

namespace ringdown::fem {

struct EstimateOptions {
  int steps = 3;
  int threads = 1;
  int blocks = 2;  // 0 point, 1 3x3, 2 entity
};
// relative lambda drops, unscaled
Eigen::VectorXd surplus_drop(const mesh::TetMesh& mesh, const Elastic& elastic,
                             const Eigen::Ref<const Eigen::VectorXd>& lambda,
                             const Eigen::Ref<const Eigen::MatrixXd>& shapes, const EstimateOptions& options);

}  // namespace ringdown::fem
