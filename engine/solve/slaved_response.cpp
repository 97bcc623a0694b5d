#include "engine/solve/slaved_response.h"

#include "engine/base/in_parallel.h"
#include "engine/base/progress.h"
#include "engine/solve/methods.h"

#include <algorithm>

namespace ringdown::solve {

SlavedResponse::SlavedResponse(const fem::System& system, const Eigen::MatrixXd& kept, double shift, int threads)
    : kept_(kept),
      heavy_(fem::mass_times(system.node_mass, kept)),
      shift_(shift),
      pencil_(system, thread_count(threads)) {}

Result<void> SlavedResponse::factor(const std::function<bool()>& keep_going) {
  try {
    const auto count = pencil_.factor(shift_, Pencil::kDown, [&](double) { return !keep_going || keep_going(); });
    if (!count) return fail(count);
  } catch (const Cancelled&) {
    return fail_cancelled();
  }
  pencil_.release_workspace();
  return {};
}

Eigen::MatrixXd SlavedResponse::operator()(const Eigen::MatrixXd& forces) const {
  Eigen::MatrixXd ordered = forces - heavy_ * (kept_.transpose() * forces);
  ordered = pencil_.in_elimination_order(ordered);
  Block block(kWidth, forces.rows());
  for (Eigen::Index first = 0; first < forces.cols(); first += kWidth) {
    const Eigen::Index count = std::min<Eigen::Index>(kWidth, forces.cols() - first);
    block.setZero();
    block.topRows(count) = ordered.middleCols(first, count).transpose();
    pencil_.factors().solve(block);
    ordered.middleCols(first, count) = block.topRows(count).transpose();
  }
  Eigen::MatrixXd answers = pencil_.in_mesh_order(ordered);
  answers.noalias() -= kept_ * (heavy_.transpose() * answers);
  return answers;
}

}  // namespace ringdown::solve
