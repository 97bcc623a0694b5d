#include "tests/mesh/stuffing/accuracy.h"

#include "engine/solve/eigensolver.h"
#include "tests/fem/sample_meshes.h"

#include <cmath>
#include <numbers>

namespace ringdown::test {

Eigen::VectorXd frequencies(const mesh::TetMesh& mesh, int order, double highest_hz) {
  const mesh::TetMesh raised = mesh::to_order(mesh, order);
  const auto system = fem::assemble(raised, fem::Elastic{200e9, 0.3, 7850}, element_of(raised));
  if (!system) return {};
  const double pi = std::numbers::pi;
  const auto modes = solve::solve_modes(*system, {.highest_lambda = std::pow(2 * pi * highest_hz, 2)});
  if (!modes) return {};
  return modes->lambda.tail(modes->lambda.size() - modes->rigid).array().sqrt() / (2 * pi);
}

Errors errors(const Eigen::VectorXd& found, std::span<const double> truth) {
  Errors result;
  for (int mode = 0; mode < 10; ++mode) {
    const double error = mode < found.size() ? found[mode] / truth[mode] - 1 : 1;
    result.mean += error / 10;
    if (std::abs(error) > std::abs(result.max)) result.max = error;
  }
  return result;
}

}  // namespace ringdown::test
