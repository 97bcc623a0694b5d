#include "engine/mesh/tet_mesh.h"

#include <Eigen/LU>

#include <algorithm>
#include <unordered_map>
#include <utility>
#include <vector>

namespace ringdown::mesh {
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

  // Which node is which does not depend on where they are: the places come afterwards, from the parents' own maps.
  TetMesh fine = to_order(straight, mesh.order());
  const Lattice inside = lattice(mesh.order()), ten = lattice(2);
  for (Eigen::Index e = 0; e < fine.elements.rows(); ++e) {
    const ElementNodes parent = nodes_of(mesh, e / 8);
    Eigen::Matrix4d corners;
    for (int i = 0; i < 4; ++i) corners.row(i) = ten.row(children[e / 8][e % 8][i]);
    for (Eigen::Index a = 0; a < fine.elements.cols(); ++a) {
      const Eigen::Vector4d at = (inside.row(a) * corners).transpose();
      fine.nodes.row(fine.elements(e, a)) = shape(mesh.order(), at).transpose() * parent;
    }
  }
  return fine;
}

}  // namespace ringdown::mesh
