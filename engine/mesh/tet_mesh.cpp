#include "engine/mesh/tet_mesh.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>
#include <utility>
#include <vector>

namespace ringdown::mesh {

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

// Straightening folded elements
//
// The map of a curved element from the reference tetrahedron may fold over itself: where its Jacobian determinant is
// not positive, the element is inside out and its energy has no meaning. Each round visits every element. An element
// that folds is pulled half of the way towards its straight form; after three such rounds it becomes straight. Pulling
// moves nodes that neighbours share, which may bend a neighbour more, so rounds repeat until no element folds. Halving
// keeps more of the geometry than straightening at once: of a ball of 50 elements of order 4, three fold.
namespace {

// Keeps the fraction `kept` of every node's distance from its place in the straight element.
void pull_straight(TetMesh& mesh, Eigen::Index element, double kept) {
  const ElementNodes straight = straight_nodes(mesh.order(), corners_of(mesh, element));
  for (Eigen::Index a = 4; a < straight.rows(); ++a) {
    auto node = mesh.nodes.row(mesh.elements(element, a));
    node = straight.row(a) + kept * (node - straight.row(a));
  }
}

// Evaluates det J of a curved element, a polynomial of degree 3 (p - 1), at as many points as determine the polynomial
// and at the points of both rules that assembly integrates with.
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
    for (const Eigen::Vector4d& point : points) gradients_.push_back(interpolation_gradient(order, point));
  }

  [[nodiscard]] bool folds(const ElementNodes& nodes) const {
    if (is_straight(nodes)) return false;
    const double min = 1e-3 * jacobian(Corners(nodes.topRows<4>())).determinant();
    return std::any_of(gradients_.begin(), gradients_.end(), [&](const ReferenceGradient& gradient) {
      return !(jacobian(nodes, gradient).determinant() >= min);
    });
  }

 private:
  std::vector<ReferenceGradient> gradients_;
};

}  // namespace

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

// Changing the order
//
// The corners keep their numbers. Every other node of the new order has a NodeKey that is equal in all elements around
// the node: the corners it lies between, each with its barycentric share. The first element that meets a key computes
// the node's position by its own map and assigns the next number; later elements look the number up.
namespace {

// The corners around a node in ascending order, each with its share p l_i in the lowest three bits; unused places are
// 0.
using NodeKey = std::array<std::int64_t, 4>;

struct NodeKeyHash {
  std::size_t operator()(const NodeKey& key) const {
    std::uint64_t hash = 0;
    for (const std::int64_t part : key) hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9E3779B97F4A7C15u;
    return hash ^ (hash >> 32);
  }
};

NodeKey key_of(const TetMesh& mesh, Eigen::Index element, const Eigen::RowVector4d& shares) {
  NodeKey key{};
  for (int i = 0; i < 4; ++i) {
    const auto share = static_cast<std::int64_t>(std::lround(shares[i]));
    if (share > 0) key[i] = (std::int64_t{mesh.elements(element, i)} << 3) + share;
  }
  std::sort(key.begin(), key.end());
  return key;
}

}  // namespace

TetMesh to_order(const TetMesh& mesh, int order) {
  if (mesh.order() == order) return mesh;
  const Barycentric points = reference_nodes(order);
  Eigen::MatrixXd from_old(points.rows(), mesh.elements.cols());
  for (Eigen::Index a = 0; a < points.rows(); ++a)
    from_old.row(a) = interpolation(mesh.order(), points.row(a).transpose());

  TetMesh changed;
  changed.elements.resize(mesh.elements.rows(), points.rows());
  changed.elements.leftCols<4>() = mesh.elements.leftCols<4>();
  changed.nodes = mesh.nodes;
  drop_unused_nodes(changed.nodes, changed.elements.leftCols<4>());
  auto next = static_cast<std::int32_t>(changed.nodes.rows());
  std::unordered_map<NodeKey, std::int32_t, NodeKeyHash> number_at;
  std::vector<Eigen::RowVector3d> added;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    const ElementNodes own = nodes_of(mesh, e);
    for (Eigen::Index a = 4; a < points.rows(); ++a) {
      const auto [found, is_new] = number_at.try_emplace(key_of(mesh, e, order * points.row(a)), next);
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

// Splitting each element into eight
//
// First the elements are split as if they were straight. The middles of the six edges become corners, numbered once for
// all elements around an edge. Four children lie at the parent's corners, and the remaining octahedron is cut in four
// around its shortest diagonal, which keeps the children's angles from degenerating. The children then get the nodes of
// the parent's order, and each node moves to the place that the parent's own map gives.
namespace {

// The ten points that children have as corners: the parent's corners, and the middles of its edges.
using Child = std::array<int, 4>;
using Children = std::array<Child, 8>;

// The octahedron's three diagonals join the middles of opposite edges of kTetEdges; `ring` goes around each.
struct Diagonal {
  int from, to;
  std::array<int, 4> ring;
};
constexpr std::array<Diagonal, 3> kDiagonals = {{{4, 9, {5, 6, 7, 8}}, {5, 7, {4, 6, 9, 8}}, {6, 8, {4, 5, 9, 7}}}};

Children children_of(const Corners& corners) {
  Eigen::Matrix<double, 10, 3> points;
  points.topRows<4>() = corners;
  for (int e = 0; e < 6; ++e) points.row(4 + e) = 0.5 * (corners.row(kTetEdges[e][0]) + corners.row(kTetEdges[e][1]));
  const auto length = [&](const Diagonal& d) { return (points.row(d.to) - points.row(d.from)).squaredNorm(); };
  const Diagonal& shortest = *std::min_element(kDiagonals.begin(), kDiagonals.end(),
                                               [&](const auto& a, const auto& b) { return length(a) < length(b); });

  Children children = {{{0, 4, 6, 7}, {1, 5, 4, 8}, {2, 6, 5, 9}, {3, 8, 7, 9}}};
  for (int k = 0; k < 4; ++k)
    children[4 + k] = {shortest.from, shortest.to, shortest.ring[k], shortest.ring[(k + 1) % 4]};
  for (Child& child : children) {
    Corners at;
    for (int i = 0; i < 4; ++i) at.row(i) = points.row(child[i]);
    if (jacobian(at).determinant() < 0) std::swap(child[2], child[3]);
  }
  return children;
}

std::uint64_t edge_key(std::int32_t a, std::int32_t b) {
  const auto [low, high] = std::minmax(a, b);
  return (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint32_t>(high);
}

}  // namespace

TetMesh split(const TetMesh& mesh) {
  TetMesh straight;
  straight.nodes = mesh.nodes;
  straight.elements.resize(8 * mesh.elements.rows(), 4);
  std::vector<Children> children;
  std::unordered_map<std::uint64_t, std::int32_t> middles;
  auto next = static_cast<std::int32_t>(mesh.nodes.rows());
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    std::array<std::int32_t, 10> numbers{};
    for (int i = 0; i < 4; ++i) numbers[i] = mesh.elements(e, i);
    for (int k = 0; k < 6; ++k) {
      const auto [found, is_new] =
          middles.try_emplace(edge_key(numbers[kTetEdges[k][0]], numbers[kTetEdges[k][1]]), next);
      if (is_new) ++next;
      numbers[4 + k] = found->second;
    }
    children.push_back(children_of(corners_of(mesh, e)));
    for (int c = 0; c < 8; ++c) {
      for (int i = 0; i < 4; ++i) straight.elements(8 * e + c, i) = numbers[children.back()[c][i]];
    }
  }
  straight.nodes.conservativeResize(next, 3);
  straight.nodes.bottomRows(next - mesh.nodes.rows()).setZero();

  // The numbering of nodes does not depend on their positions, so positions are set last, by the parents' own maps.
  TetMesh fine = to_order(straight, mesh.order());
  const Barycentric inside = reference_nodes(mesh.order()), ten = reference_nodes(2);
  for (Eigen::Index e = 0; e < fine.elements.rows(); ++e) {
    const ElementNodes parent = nodes_of(mesh, e / 8);
    Eigen::Matrix4d corners;
    for (int i = 0; i < 4; ++i) corners.row(i) = ten.row(children[e / 8][e % 8][i]);
    for (Eigen::Index a = 0; a < fine.elements.cols(); ++a) {
      const Eigen::Vector4d at = (inside.row(a) * corners).transpose();
      fine.nodes.row(fine.elements(e, a)) = interpolation(mesh.order(), at).transpose() * parent;
    }
  }
  return fine;
}

double volume_of(const TetMesh& mesh) {
  double volume = 0;
  const int order = mesh.order();
  for (const QuadraturePoint& point : tet_quadrature(std::max(3 * (order - 1), 1))) {
    const ReferenceGradient gradient = interpolation_gradient(order, point.barycentric);
    for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
      volume += point.weight * jacobian(nodes_of(mesh, e), gradient).determinant() / 6;
    }
  }
  return volume;
}

TetQuality quality_of(const TetMesh& mesh) {
  TetQuality quality{.shortest_edge_m = std::numeric_limits<double>::max()};
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    const Corners corners = corners_of(mesh, e);
    std::array<Eigen::RowVector3d, 4> outward;
    for (int f = 0; f < 4; ++f) {
      const Eigen::RowVector3d a = corners.row(kTetFaces[f][0]), b = corners.row(kTetFaces[f][1]),
                               c = corners.row(kTetFaces[f][2]);
      outward[f] = (b - a).cross(c - a).normalized();
    }
    for (int f = 0; f < 4; ++f) {
      for (int g = f + 1; g < 4; ++g) {
        const double angle = 180 / std::numbers::pi * std::acos(std::clamp(-outward[f].dot(outward[g]), -1.0, 1.0));
        quality.smallest_angle_deg = std::min(quality.smallest_angle_deg, angle);
        quality.largest_angle_deg = std::max(quality.largest_angle_deg, angle);
      }
    }
    for (const auto& [a, b] : kTetEdges) {
      const double length = (corners.row(b) - corners.row(a)).norm();
      quality.shortest_edge_m = std::min(quality.shortest_edge_m, length);
      quality.longest_edge_m = std::max(quality.longest_edge_m, length);
    }
  }
  return quality;
}

}  // namespace ringdown::mesh
