#include "engine/solve/pencil.h"

#include "engine/solve/methods.h"

#include <string>

namespace ringdown::solve {
namespace {

constexpr double kBackwardError = 1e-10;  // limit for a solve; above, the shift moves
constexpr double kStep = 3e-4;            // relative step of the shift
constexpr int kMaxSteps = 3;

}  // namespace

Pencil::Pencil(const fem::System& system, int threads)
    : system_(system),
      team_(threads),
      plan_(plan_elimination(system, threads)),
      ordered_(system, plan_, team_),
      factors_(plan_, ordered_, team_) {}

Result<Count> Pencil::factor(double lambda, Step step, const KeepGoing& keep_going) {
  const double start = seconds_now();
  for (int attempt = 0; attempt <= kMaxSteps; ++attempt, lambda *= step == kUp ? 1 + kStep : 1 - kStep) {
    ++factorizations_;
    if (!factors_.factor(lambda, [&] { return !keep_going || keep_going(0); })) continue;
    if (factors_.backward_error() > kBackwardError) continue;
    factor_seconds_ += seconds_now() - start;
    return Count{lambda, factors_.negative()};
  }
  return fail(ErrorKind::bad_input,
              "the stiffness of the mesh could not be factored ({} unknowns); check the mesh for flat elements, or "
              "make it coarser if memory ran out",
              unknowns());
}

Eigen::MatrixXd Pencil::in_mesh_order(const Eigen::Ref<const Eigen::MatrixXd>& shapes) const {
  Eigen::MatrixXd result(shapes.rows(), shapes.cols());
  for (Eigen::Index m = 0; m < shapes.cols(); ++m) {
    for (int n = 0; n < plan_.node_count(); ++n) {
      result.col(m).segment<3>(3 * plan_.old_of[n]) = shapes.col(m).segment<3>(3 * n);
    }
  }
  return result;
}

Eigen::MatrixXd Pencil::in_elimination_order(const Eigen::Ref<const Eigen::MatrixXd>& shapes) const {
  Eigen::MatrixXd result(shapes.rows(), shapes.cols());
  for (Eigen::Index m = 0; m < shapes.cols(); ++m) {
    for (int n = 0; n < plan_.node_count(); ++n) {
      result.col(m).segment<3>(3 * n) = shapes.col(m).segment<3>(3 * plan_.old_of[n]);
    }
  }
  return result;
}

}  // namespace ringdown::solve
