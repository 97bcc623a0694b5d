#include "engine/mesh/tet_mesh.h"

#include "engine/mesh/tet_shape.h"

#include <Eigen/LU>

#include <algorithm>
#include <cassert>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <vector>

namespace ringdown::mesh {
namespace {

Corners corners_of(const TetMesh& mesh, Eigen::Index element) {
  Corners corners;
  for (int a = 0; a < 4; ++a) corners.row(a) = mesh.nodes.row(mesh.elements(element, a));
  return corners;
}

Nodes10 nodes_of(const TetMesh& mesh, Eigen::Index element) {
  Nodes10 nodes;
  for (int a = 0; a < 10; ++a) nodes.row(a) = mesh.nodes.row(mesh.elements(element, a));
  return nodes;
}

// The determinant of an equilateral tetrahedron of edge h is h^3 / sqrt(2): below 1e-9 h^3 there is no
// volume.
bool is_flat(const Corners& corners, double determinant) {
  double longest = 0;
  for (const auto& [i, j] : kTetEdges) longest = std::max(longest, (corners.row(i) - corners.row(j)).norm());
  return !(std::abs(determinant) > 1e-9 * longest * longest * longest);
}

void flip(TetMesh& mesh, Eigen::Index element) {
  auto row = mesh.elements.row(element);
  std::swap(row[1], row[2]);
  if (!mesh.quadratic()) return;
  std::swap(row[4], row[6]);  // edges 0-1 and 2-0
  std::swap(row[8], row[9]);  // edges 1-3 and 2-3
}

void straighten(TetMesh& mesh, Eigen::Index element) {
  const auto row = mesh.elements.row(element);
  for (int e = 0; e < 6; ++e) {
    mesh.nodes.row(row[4 + e]) = 0.5 * (mesh.nodes.row(row[kTetEdges[e][0]]) + mesh.nodes.row(row[kTetEdges[e][1]]));
  }
}

// Where a curved element is looked at: its nodes and the points that assembly integrates over.
std::vector<Gradient10> gradients_to_check() {
  std::vector<Gradient10> gradients;
  for (int i = 0; i < 4; ++i) gradients.push_back(reference_gradient10(Eigen::Vector4d::Unit(i)));
  for (const auto& [i, j] : kTetEdges) {
    gradients.push_back(reference_gradient10(0.5 * (Eigen::Vector4d::Unit(i) + Eigen::Vector4d::Unit(j))));
  }
  for (const int degree : {4, 7}) {
    for (const QuadraturePoint& point : tet_quadrature(degree)) {
      gradients.push_back(reference_gradient10(point.barycentric));
    }
  }
  return gradients;
}

bool folds(const Nodes10& nodes, const std::vector<Gradient10>& gradients) {
  if (is_straight(nodes)) return false;
  const double straight = jacobian4(nodes.topRows<4>()).determinant();
  return std::any_of(gradients.begin(), gradients.end(), [&](const Gradient10& gradient) {
    return jacobian10(nodes, gradient).determinant() < 1e-3 * straight;
  });
}

// Straightening an element bends its neighbours less or more, so it is repeated until none folds.
int straighten_folded(TetMesh& mesh) {
  const std::vector<Gradient10> gradients = gradients_to_check();
  std::vector<bool> straightened(mesh.elements.rows(), false);
  for (bool again = true; again;) {
    again = false;
    for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
      if (straightened[e] || !folds(nodes_of(mesh, e), gradients)) continue;
      straighten(mesh, e);
      straightened[e] = again = true;
    }
  }
  return static_cast<int>(std::count(straightened.begin(), straightened.end(), true));
}

// Renumbers the nodes in use, keeping their order. Returns how many were dropped.
int drop_unused_nodes(TetMesh& mesh) {
  std::vector<std::int32_t> number(mesh.nodes.rows(), -1);
  for (const std::int32_t node : mesh.elements.reshaped()) number[node] = 0;
  std::int32_t used = 0;
  for (Eigen::Index node = 0; node < mesh.nodes.rows(); ++node) {
    if (number[node] < 0) continue;
    mesh.nodes.row(used) = mesh.nodes.row(node).eval();
    number[node] = used++;
  }
  const auto dropped = static_cast<int>(mesh.nodes.rows() - used);
  mesh.nodes.conservativeResize(used, 3);
  for (std::int32_t& node : mesh.elements.reshaped()) node = number[node];
  return dropped;
}

int count_pieces(const TetMesh& mesh) {
  std::vector<std::int32_t> parent(mesh.nodes.rows());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t node) {
    while (parent[node] != node) node = parent[node] = parent[parent[node]];
    return node;
  };
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    for (Eigen::Index a = 1; a < mesh.elements.cols(); ++a) {
      parent[root(mesh.elements(e, a))] = root(mesh.elements(e, 0));
    }
  }
  int pieces = 0;
  for (std::int32_t node = 0; node < mesh.nodes.rows(); ++node) pieces += root(node) == node;
  return pieces;
}

Result<void> check_numbers(const TetMesh& mesh, const std::string& name) {
  if (mesh.elements.rows() == 0) {
    return fail(name + " has no tetrahedra; a solid is needed, so mesh its volume, not only its surface");
  }
  if (mesh.elements.cols() != 4 && mesh.elements.cols() != 10) {
    return fail(name + " has elements of " + std::to_string(mesh.elements.cols()) +
                " nodes; give tetrahedra of 4 or 10 nodes");
  }
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    for (const std::int32_t node : mesh.elements.row(e)) {
      if (node >= 0 && node < mesh.nodes.rows()) continue;
      return fail(name + ": element " + std::to_string(e) + " names node " + std::to_string(node) +
                  ", but there are only " + std::to_string(mesh.nodes.rows()));
    }
  }
  for (Eigen::Index node = 0; node < mesh.nodes.rows(); ++node) {
    if (!mesh.nodes.row(node).allFinite()) {
      return fail(name + ": a coordinate of node " + std::to_string(node) + " is not a finite number");
    }
  }
  return {};
}

}  // namespace

Result<CheckedMesh> check_mesh(TetMesh mesh, const std::string& name) {
  if (auto numbers = check_numbers(mesh, name); !numbers) return fail(numbers.error());
  CheckedMesh checked{.mesh = std::move(mesh)};
  checked.unused_nodes = drop_unused_nodes(checked.mesh);
  for (Eigen::Index e = 0; e < checked.mesh.elements.rows(); ++e) {
    const Corners corners = corners_of(checked.mesh, e);
    const double determinant = jacobian4(corners).determinant();
    if (is_flat(corners, determinant)) {
      return fail(name + ": element " + std::to_string(e) + " has no volume (its four corners lie in a plane); " +
                  "mesh the object again, or repair it in a mesh tool");
    }
    if (determinant > 0) continue;
    flip(checked.mesh, e);
    ++checked.flipped;
  }
  if (checked.mesh.quadratic()) checked.straightened = straighten_folded(checked.mesh);
  checked.pieces = count_pieces(checked.mesh);
  return checked;
}

TetMesh to_quadratic(const TetMesh& mesh) {
  if (mesh.quadratic()) return mesh;
  TetMesh quadratic;
  quadratic.elements.resize(mesh.elements.rows(), 10);
  std::unordered_map<std::uint64_t, std::int32_t> middle_of;
  std::vector<Eigen::RowVector3d> middles;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    quadratic.elements.row(e).head<4>() = mesh.elements.row(e);
    for (int k = 0; k < 6; ++k) {
      const auto [low, high] = std::minmax(mesh.elements(e, kTetEdges[k][0]), mesh.elements(e, kTetEdges[k][1]));
      const std::uint64_t edge = (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint32_t>(high);
      const auto next = static_cast<std::int32_t>(mesh.nodes.rows() + static_cast<Eigen::Index>(middles.size()));
      const auto [found, is_new] = middle_of.try_emplace(edge, next);
      if (is_new) middles.push_back(0.5 * (mesh.nodes.row(low) + mesh.nodes.row(high)));
      quadratic.elements(e, 4 + k) = found->second;
    }
  }
  quadratic.nodes.resize(mesh.nodes.rows() + static_cast<Eigen::Index>(middles.size()), 3);
  quadratic.nodes.topRows(mesh.nodes.rows()) = mesh.nodes;
  for (std::size_t k = 0; k < middles.size(); ++k) {
    quadratic.nodes.row(mesh.nodes.rows() + static_cast<Eigen::Index>(k)) = middles[k];
  }
  return quadratic;
}

TetMesh to_linear(const TetMesh& mesh) {
  if (!mesh.quadratic()) return mesh;
  TetMesh linear{mesh.nodes, mesh.elements.leftCols<4>()};
  drop_unused_nodes(linear);
  return linear;
}

}  // namespace ringdown::mesh
