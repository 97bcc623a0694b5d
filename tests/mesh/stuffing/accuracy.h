// Frequencies of stuffed bodies against those that are known.
#pragma once

#include "engine/mesh/tet_mesh.h"

#include <Eigen/Core>

#include <span>

namespace ringdown::test {

// Elastic modes [Hz] of a steel body, E = 200 GPa, nu = 0.3, 7850 kg/m^3, below highest_hz, without the rigid ones.
Eigen::VectorXd frequencies(const mesh::TetMesh& mesh, int order, double highest_hz);

struct Errors {
  double max = 0, mean = 0;  // of the first ten modes, relative
};
Errors errors(const Eigen::VectorXd& found, std::span<const double> truth);

}  // namespace ringdown::test
