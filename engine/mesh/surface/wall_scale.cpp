#include "engine/mesh/surface/wall_scale.h"

#include "engine/mesh/boundary.h"
#include "engine/mesh/surface/surface_distance.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <array>
#include <limits>
#include <vector>

// From walls to a motion of all nodes
//
// Each element looks through the body from its middle in a few directions. A view counts if both sides that it meets
// face it, to within acos(kFacing); the shortest one that counts gives the normal n of the wall, as the mean of the
// normals of its two sides. An element near a rim, which may see its wall from none of the directions, tries those of
// its neighbours as well.
//
// The motion u of the nodes should stretch each element by (factor - 1) along n and not at all across it:
// grad u = (factor - 1) n n^T. Of a plate such a motion exists; of a curved wall nearly, because its sides grow or
// shrink along themselves as they move. The least squares solution is that of one Poisson equation for each axis,
//
//   sum_e w_e V_e grad N_i . grad u_k = sum_e w_e V_e (factor - 1) n_k grad N_i . n,
//
// with linear shape functions N_i of the corners. Elements that see no wall have no stretch and little weight: they
// follow their neighbours.
namespace ringdown::mesh {
namespace {

using Eigen::RowVector3d;

constexpr double kFacing = 0.8;

// A way through the body; `normal` is zero if there is none.
struct Crossing {
  double length_m = std::numeric_limits<double>::max();
  RowVector3d normal = RowVector3d::Zero();

  [[nodiscard]] bool exists() const { return length_m < std::numeric_limits<double>::max(); }
};

Crossing crossing_of(const SurfaceRays& rays, const RowVector3d& middle, const RowVector3d& direction) {
  const auto ahead = rays.first(middle, direction), behind = rays.first(middle, -direction);
  if (!ahead || !behind) return {};
  if (ahead->normal.dot(direction) < kFacing || behind->normal.dot(direction) > -kFacing) return {};
  return {ahead->distance_m + behind->distance_m, (ahead->normal - behind->normal).normalized()};
}

// Takes the crossing along `direction`, and then the one along the normal that it found, where these are shorter.
void offer(Crossing& best, const SurfaceRays& rays, const RowVector3d& middle, RowVector3d direction) {
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    const Crossing found = crossing_of(rays, middle, direction);
    if (!(found.length_m < best.length_m)) return;
    best = found;
    direction = found.normal;
  }
}

// The axes of a cube through its faces, edges and corners: no direction is further than 28 degrees from one of these.
std::vector<RowVector3d> directions() {
  std::vector<RowVector3d> all;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const std::array<int, 3> place{x, y, z};
        if (place > std::array<int, 3>{0, 0, 0}) all.push_back(RowVector3d(x, y, z).normalized());
      }
    }
  }
  return all;
}

std::vector<Crossing> crossings_of(const TetMesh& mesh) {
  constexpr int kSweeps = 2;
  const SurfaceRays rays(skin_of(mesh));
  const std::vector<RowVector3d> all = directions();
  const auto middle_of = [&mesh](std::size_t e) -> RowVector3d {
    return corners_of(mesh, static_cast<Eigen::Index>(e)).colwise().mean();
  };
  std::vector<Crossing> best(static_cast<std::size_t>(mesh.elements.rows()));
  for (std::size_t e = 0; e < best.size(); ++e) {
    for (const RowVector3d& direction : all) offer(best[e], rays, middle_of(e), direction);
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    std::vector<Crossing> at_node(static_cast<std::size_t>(mesh.nodes.rows()));
    const auto node = [&](std::size_t e, int corner) -> Crossing& {
      return at_node[static_cast<std::size_t>(mesh.elements(static_cast<Eigen::Index>(e), corner))];
    };
    for (std::size_t e = 0; e < best.size(); ++e) {
      for (int corner = 0; corner < 4; ++corner) {
        if (best[e].length_m < node(e, corner).length_m) node(e, corner) = best[e];
      }
    }
    for (std::size_t e = 0; e < best.size(); ++e) {
      for (int corner = 0; corner < 4; ++corner) {
        if (node(e, corner).exists()) offer(best[e], rays, middle_of(e), node(e, corner).normal);
      }
    }
  }
  return best;
}

// The motion of all corners that stretches the elements by `stretch` along their walls' normals; other nodes have zero.
Points motion_of(const TetMesh& mesh, const std::vector<Crossing>& crossings, double stretch) {
  constexpr double kFollows = 0.01;  // weight of elements that see no wall
  constexpr double kHold = 1e-10;    // of the diagonal: keeps the body as a whole in its place
  std::vector<Eigen::Triplet<double>> entries;
  Points load = Points::Zero(mesh.nodes.rows(), 3);
  double largest = 0;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    const Crossing& crossing = crossings[static_cast<std::size_t>(e)];
    const Eigen::Matrix3d map = jacobian(corners_of(mesh, e));
    Eigen::Matrix<double, 4, 3> gradient;  // of N_i, a row each
    gradient.bottomRows<3>() = map.inverse().transpose();
    gradient.row(0) = -gradient.bottomRows<3>().colwise().sum();
    const double weight = map.determinant() / 6 * (crossing.exists() ? 1 : kFollows);
    const Eigen::Matrix4d block = weight * gradient * gradient.transpose();
    const Eigen::Matrix<double, 4, 3> pull =
        weight * stretch * (gradient * crossing.normal.transpose()) * crossing.normal;
    for (int i = 0; i < 4; ++i) {
      load.row(mesh.elements(e, i)) += pull.row(i);
      largest = std::max(largest, block(i, i));
      for (int j = 0; j < 4; ++j) entries.emplace_back(mesh.elements(e, i), mesh.elements(e, j), block(i, j));
    }
  }
  for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n)
    entries.emplace_back(static_cast<int>(n), static_cast<int>(n), kHold * largest);
  Eigen::SparseMatrix<double> poisson(mesh.nodes.rows(), mesh.nodes.rows());
  poisson.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(poisson);
  return factors.solve(Eigen::MatrixXd(load));
}

// Moves corners by `motion` and all other nodes as the straight elements between the corners would move them.
void move_nodes(TetMesh& mesh, const Points& motion) {
  const Barycentric places = reference_nodes(mesh.order());
  Points moved = mesh.nodes + motion;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    Eigen::Matrix<double, 4, 3> corners;
    for (int i = 0; i < 4; ++i) corners.row(i) = motion.row(mesh.elements(e, i));
    for (Eigen::Index a = 4; a < mesh.elements.cols(); ++a)
      moved.row(mesh.elements(e, a)) = mesh.nodes.row(mesh.elements(e, a)) + places.row(a) * corners;
  }
  mesh.nodes = std::move(moved);
}

}  // namespace

Result<void> scale_walls(TetMesh& mesh, double factor, const std::string& name) {
  const std::vector<Crossing> crossings = crossings_of(mesh);
  if (std::ranges::none_of(crossings, &Crossing::exists))
    return fail(ErrorKind::bad_input, "{} has no two sides that face apart, so its wall cannot be scaled", name);
  move_nodes(mesh, motion_of(mesh, crossings, factor - 1));
  if (mesh.order() > 1) straighten_folded(mesh);
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    if (jacobian(corners_of(mesh, e)).determinant() > 0) continue;
    return fail(ErrorKind::bad_input,
                "the walls of {} cannot be scaled by {:.3g}: elements would fold; name a factor "
                "nearer to 1",
                name, factor);
  }
  return {};
}

}  // namespace ringdown::mesh
