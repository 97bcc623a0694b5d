#include "engine/bake/laboratory/residual_of.h"

#include "engine/fem/holding.h"
#include "engine/modal/damping.h"
#include "engine/solve/slaved_response.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::bake {
namespace {

// The rows of 3N x m numbers that belong to nodes which are not clamped.
Eigen::MatrixXd without_nodes(const Eigen::MatrixXd& whole, const std::vector<std::int32_t>& clamped) {
  Eigen::MatrixXd left(whole.rows() - 3 * static_cast<Eigen::Index>(clamped.size()), whole.cols());
  Eigen::Index row = 0;
  for (std::int32_t node = 0; node < whole.rows() / 3; ++node) {
    if (std::binary_search(clamped.begin(), clamped.end(), node)) continue;
    left.middleRows<3>(row) = whole.middleRows<3>(3 * Eigen::Index{node});
    row += 3;
  }
  return left;
}

// Maps forces at the sample points to forces at the nodes: 3N x 3P. Its transpose maps displacements back.
fem::SparseMatrix forces_at(const mesh::TetMesh& mesh, const std::vector<modal::Vec3f>& points) {
  const std::vector<mesh::OuterFace> faces = mesh::outer_faces(mesh.elements);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Eigen::Vector3d point(points[p][0], points[p][1], points[p][2]);
    const fem::HeldPoint at = fem::nearest_point(mesh, faces, point);
    const Eigen::VectorXd shares = mesh::interpolation(mesh.order(), at.barycentric);
    for (Eigen::Index a = 0; a < shares.size(); ++a) {
      for (int axis = 0; axis < 3; ++axis)
        entries.emplace_back(3 * mesh.elements(at.element, a) + axis, 3 * static_cast<int>(p) + axis, shares[a]);
    }
  }
  fem::SparseMatrix forces(3 * mesh.nodes.rows(), 3 * static_cast<Eigen::Index>(points.size()));
  forces.setFromTriplets(entries.begin(), entries.end());
  return forces;
}

void put(const Eigen::MatrixXd& columns, Eigen::Index first, std::vector<float>& matrix) {
  const Eigen::Index rows = columns.rows();
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    for (Eigen::Index r = 0; r < rows; ++r)
      matrix[static_cast<std::size_t>(rows * r + first + c)] = static_cast<float>(columns(r, c));
  }
}

void make_symmetric(std::vector<float>& matrix, std::size_t rows) {
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < r; ++c) {
      const float mean = (matrix[rows * r + c] + matrix[rows * c + r]) / 2;
      matrix[rows * r + c] = matrix[rows * c + r] = mean;
    }
  }
}

}  // namespace

Result<modal::Residual> residual_of(const Baked& baked, const Progress& progress) {
  constexpr double kShift = -1e-7;  // of the lowest eigenvalue: its share is the error of the result
  constexpr Eigen::Index kAtOnce = 64;
  const modal::Bank& bank = baked.bank;
  if (!bank.provenance.liquids.empty())
    return fail(ErrorKind::refused, bank.name + ": a residual is not computed for a body with a liquid");
  if (bank.point_count() > modal::kMaxResidualPoints)
    return fail(ErrorKind::too_large, bank.name + " has " + std::to_string(bank.point_count()) +
                                          " sample points; a residual takes at most " +
                                          std::to_string(modal::kMaxResidualPoints) + " (--points)");
  const SolvedBody& body = *baked.body;
  const auto& [unsprung, springs, clamped, rigid] = *body.equations;
  fem::System whole = unsprung, left;
  if (springs.rows() > 0) whole.stiffness += springs;
  if (!clamped.empty()) fem::remove_nodes(clamped, whole, left);
  const fem::System& moving = clamped.empty() ? whole : left;
  Eigen::MatrixXd kept(body.shapes.rows(), rigid.cols() + body.shapes.cols());
  kept << rigid, body.shapes;
  kept = without_nodes(kept, clamped);
  double lowest = modal::undamped_lambda({bank.frequency_hz[0], bank.decay_per_s[0]});
  for (std::size_t m = 1; m < bank.mode_count(); ++m)
    lowest = std::min(lowest, modal::undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]}));
  solve::SlavedResponse response(moving, kept, kShift * lowest);
  if (auto factored = response.factor([&] { return !progress || progress("residual", 0); }); !factored)
    return fail(factored);

  const fem::SparseMatrix forces = forces_at(body.mesh, bank.positions);
  const Eigen::Index rows = forces.cols();
  modal::Residual residual{.points = bank.point_count(),
                           .flexibility = std::vector<float>(static_cast<std::size_t>(rows * rows)),
                           .inertia = std::vector<float>(static_cast<std::size_t>(rows * rows))};
  const auto seen = [&](const Eigen::MatrixXd& moved) -> Eigen::MatrixXd {
    return forces.transpose() * (clamped.empty() ? moved : fem::with_nodes(moved, clamped));
  };
  for (Eigen::Index first = 0; first < rows; first += kAtOnce) {
    if (progress && !progress("residual", static_cast<double>(first) / static_cast<double>(rows)))
      return fail_cancelled();
    const Eigen::Index count = std::min(kAtOnce, rows - first);
    const Eigen::MatrixXd pushes = Eigen::MatrixXd(forces.middleCols(first, count));
    const Eigen::MatrixXd moved = response(without_nodes(pushes, clamped));
    put(seen(moved), first, residual.flexibility);
    put(seen(response(fem::mass_times(moving.node_mass, moved))), first, residual.inertia);
  }
  make_symmetric(residual.flexibility, static_cast<std::size_t>(rows));
  make_symmetric(residual.inertia, static_cast<std::size_t>(rows));
  return residual;
}

}  // namespace ringdown::bake
