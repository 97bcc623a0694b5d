#include "engine/mesh/tet_mesh.h"

#include "engine/mesh/mesh_joints.h"
#include "engine/mesh/overlap.h"

#include <Eigen/LU>

#include <algorithm>
#include <cassert>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <vector>

namespace ringdown::mesh {
namespace {

// The determinant of an equilateral tetrahedron of edge h is h^3 / sqrt(2): below 1e-9 h^3 there is no
// volume.
bool is_flat(const Corners& corners, double determinant) {
  double longest = 0;
  for (const auto& [i, j] : kTetEdges) longest = std::max(longest, (corners.row(i) - corners.row(j)).norm());
  return !(std::abs(determinant) > 1e-9 * longest * longest * longest);
}

// nodes[k] of the element, exchanged with corners 1 and 2, is where node k was.
std::vector<int> flipped_nodes(int order) {
  Lattice points = lattice(order);
  points.col(1).swap(points.col(2));
  return nodes_at(order, points);
}

// Leaves `kept` of what makes an element curved.
void pull_straight(TetMesh& mesh, Eigen::Index element, double kept) {
  const ElementNodes straight = straight_nodes(mesh.order(), corners_of(mesh, element));
  for (Eigen::Index a = 4; a < straight.rows(); ++a) {
    auto node = mesh.nodes.row(mesh.elements(element, a));
    node = straight.row(a) + kept * (node - straight.row(a));
  }
}

// det J of curved elements, a polynomial of degree 3 (p - 1), in points that determine it and in those that assembly
// integrates over.
class FoldTest {
 public:
  explicit FoldTest(int order) {
    const int parts = 3 * (order - 1);
    std::vector<Eigen::Vector4d> points;
    for (int i = 0; i <= parts; ++i) {
      for (int j = 0; i + j <= parts; ++j) {
        for (int k = 0; i + j + k <= parts; ++k) {
          points.push_back(Eigen::Vector4d(parts - i - j - k, i, j, k) / parts);
        }
      }
    }
    for (const int degree : {2 * order + 1, 5 * order - 3}) {
      for (const QuadraturePoint& point : tet_quadrature(degree)) points.push_back(point.barycentric);
    }
    for (const Eigen::Vector4d& point : points) gradients_.push_back(reference_gradient(order, point));
  }

  [[nodiscard]] bool folds(const ElementNodes& nodes) const {
    if (is_straight(nodes)) return false;
    const double least = 1e-3 * jacobian(Corners(nodes.topRows<4>())).determinant();
    return std::any_of(gradients_.begin(), gradients_.end(), [&](const ReferenceGradient& gradient) {
      return !(jacobian(nodes, gradient).determinant() >= least);
    });
  }

 private:
  std::vector<ReferenceGradient> gradients_;
};

// Elements that fold lose half of their curvature, three times if need be, then all. That bends their neighbours less
// or more, so it is repeated until none folds. Halves keep more of the geometry: of a ball of 50 elements of order 4, 3
// fold.
int straighten_folded(TetMesh& mesh) {
  constexpr int kHalvings = 3;
  if (mesh.order() < 2) return 0;
  const FoldTest test(mesh.order());
  std::vector<int> pulled(mesh.elements.rows(), 0);
  for (bool again = true; again;) {
    again = false;
    for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
      if (pulled[e] > kHalvings || !test.folds(nodes_of(mesh, e))) continue;
      pull_straight(mesh, e, pulled[e] < kHalvings ? 0.5 : 0);
      ++pulled[e];
      again = true;
    }
  }
  return static_cast<int>(mesh.elements.rows() - std::count(pulled.begin(), pulled.end(), 0));
}

// Renumbers the nodes in use, keeping their order. Returns how many were dropped.
int drop_unused_nodes(Points& nodes, Eigen::Ref<Indices> elements) {
  std::vector<std::int32_t> number(nodes.rows(), -1);
  for (const auto& element : elements.rowwise()) {
    for (const std::int32_t node : element) number[node] = 0;
  }
  std::int32_t used = 0;
  for (Eigen::Index node = 0; node < nodes.rows(); ++node) {
    if (number[node] < 0) continue;
    nodes.row(used) = nodes.row(node).eval();
    number[node] = used++;
  }
  const auto dropped = static_cast<int>(nodes.rows() - used);
  nodes.conservativeResize(used, 3);
  for (auto element : elements.rowwise()) {
    for (std::int32_t& node : element) node = number[node];
  }
  return dropped;
}

// What a node is called by every element it belongs to: the corners around it in ascending order, each with its share
// p l_i; the rest is zero.
using Place = std::array<std::int64_t, 4>;

struct PlaceHash {
  std::size_t operator()(const Place& place) const {
    std::uint64_t hash = 0;
    for (const std::int64_t part : place) hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9E3779B97F4A7C15u;
    return hash ^ (hash >> 32);
  }
};

Place place_of(const TetMesh& mesh, Eigen::Index element, const Eigen::RowVector4d& shares) {
  Place place{};
  for (int i = 0; i < 4; ++i) {
    const auto share = static_cast<std::int64_t>(std::lround(shares[i]));
    if (share > 0) place[i] = (std::int64_t{mesh.elements(element, i)} << 3) + share;
  }
  std::sort(place.begin(), place.end());
  return place;
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
    return fail(ErrorKind::bad_input,
                name + " has no tetrahedra; a solid is needed, so mesh its volume, not only its surface");
  }
  if (mesh.order() == 0) {
    return fail(ErrorKind::bad_input, name + " has elements of " + std::to_string(mesh.elements.cols()) +
                                          " nodes; give tetrahedra of 4, 10, 20 or 35 nodes");
  }
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    for (const std::int32_t node : mesh.elements.row(e)) {
      if (node >= 0 && node < mesh.nodes.rows()) continue;
      return fail(ErrorKind::bad_input, name + ": element " + std::to_string(e) + " names node " +
                                            std::to_string(node) + ", but there are only " +
                                            std::to_string(mesh.nodes.rows()));
    }
  }
  std::vector<std::int32_t> own(mesh.elements.cols());
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    std::copy(mesh.elements.row(e).begin(), mesh.elements.row(e).end(), own.begin());
    std::sort(own.begin(), own.end());
    if (const auto twice = std::adjacent_find(own.begin(), own.end()); twice != own.end()) {
      return fail(ErrorKind::bad_input, name + ": element " + std::to_string(e) + " names node " +
                                            std::to_string(*twice) +
                                            " twice; mesh the object again, or repair it in a mesh tool");
    }
  }
  for (Eigen::Index node = 0; node < mesh.nodes.rows(); ++node) {
    if (!mesh.nodes.row(node).allFinite()) {
      return fail(ErrorKind::bad_input,
                  name + ": a coordinate of node " + std::to_string(node) + " is not a finite number");
    }
  }
  return {};
}

}  // namespace

Result<CheckedMesh> check_mesh(TetMesh mesh, const std::string& name) {
  if (auto numbers = check_numbers(mesh, name); !numbers) return fail(numbers.error());
  CheckedMesh checked{.mesh = std::move(mesh)};
  checked.unused_nodes = drop_unused_nodes(checked.mesh.nodes, checked.mesh.elements);
  const std::vector<int> flipped = flipped_nodes(checked.mesh.order());
  for (Eigen::Index e = 0; e < checked.mesh.elements.rows(); ++e) {
    const Corners corners = corners_of(checked.mesh, e);
    const double determinant = jacobian(corners).determinant();
    if (is_flat(corners, determinant)) {
      return fail(ErrorKind::bad_input, name + ": element " + std::to_string(e) +
                                            " has no volume (its four corners lie in a plane); " +
                                            "mesh the object again, or repair it in a mesh tool");
    }
    if (determinant > 0) continue;
    checked.mesh.elements.row(e) = checked.mesh.elements(e, flipped).eval();
    ++checked.flipped;
  }
  checked.duplicates = drop_duplicates(checked.mesh);
  if (auto joints = check_joints(checked.mesh, name); !joints) return fail(joints.error());
  if (auto apart = check_overlap(checked.mesh, name); !apart) return fail(apart.error());
  checked.straightened = straighten_folded(checked.mesh);
  checked.pieces = count_pieces(checked.mesh);
  return checked;
}

ElementNodes nodes_of(const TetMesh& mesh, Eigen::Index element) {
  ElementNodes nodes(mesh.elements.cols(), 3);
  for (Eigen::Index a = 0; a < nodes.rows(); ++a) nodes.row(a) = mesh.nodes.row(mesh.elements(element, a));
  return nodes;
}

Corners corners_of(const TetMesh& mesh, Eigen::Index element) {
  Corners corners;
  for (int a = 0; a < 4; ++a) corners.row(a) = mesh.nodes.row(mesh.elements(element, a));
  return corners;
}

TetMesh to_order(const TetMesh& mesh, int order) {
  if (mesh.order() == order) return mesh;
  const Lattice points = lattice(order);
  Eigen::MatrixXd from_old(points.rows(), mesh.elements.cols());
  for (Eigen::Index a = 0; a < points.rows(); ++a) from_old.row(a) = shape(mesh.order(), points.row(a).transpose());

  TetMesh changed;
  changed.elements.resize(mesh.elements.rows(), points.rows());
  changed.elements.leftCols<4>() = mesh.elements.leftCols<4>();
  changed.nodes = mesh.nodes;
  drop_unused_nodes(changed.nodes, changed.elements.leftCols<4>());
  auto next = static_cast<std::int32_t>(changed.nodes.rows());
  std::unordered_map<Place, std::int32_t, PlaceHash> number_at;
  std::vector<Eigen::RowVector3d> added;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    const ElementNodes own = nodes_of(mesh, e);
    for (Eigen::Index a = 4; a < points.rows(); ++a) {
      const auto [found, is_new] = number_at.try_emplace(place_of(mesh, e, order * points.row(a)), next);
      if (is_new) added.emplace_back(from_old.row(a) * own), ++next;
      changed.elements(e, a) = found->second;
    }
  }
  const Eigen::Index corners = changed.nodes.rows();
  changed.nodes.conservativeResize(next, 3);
  for (Eigen::Index n = corners; n < next; ++n) changed.nodes.row(n) = added[n - corners];
  if (order < mesh.order()) straighten_folded(changed);
  return changed;
}

}  // namespace ringdown::mesh
