#include "engine/mesh/surplus_space.h"

#include <algorithm>
#include <map>

namespace ringdown::mesh {
namespace {

using CornerOrder = std::array<int, 4>;

// The node that takes each node's place when the corners change theirs.
std::vector<int> nodes_in_order(int order, const CornerOrder& corners) {
  const Lattice points = lattice(order);
  std::vector<int> from;
  for (Eigen::Index a = 0; a < points.rows(); ++a) {
    Eigen::RowVector4d place;
    for (int i = 0; i < 4; ++i) place[corners[i]] = points(a, i);
    Eigen::Index nearest = 0;
    (points.rowwise() - place).rowwise().squaredNorm().minCoeff(&nearest);
    from.push_back(static_cast<int>(nearest));
  }
  return from;
}

Indices with_rising_corners(const TetMesh& mesh) {
  std::map<CornerOrder, std::vector<int>> known;
  Indices sorted(mesh.elements.rows(), mesh.elements.cols());
  for (Eigen::Index e = 0; e < sorted.rows(); ++e) {
    CornerOrder corners = {0, 1, 2, 3};
    std::sort(corners.begin(), corners.end(), [&](int a, int b) { return mesh.elements(e, a) < mesh.elements(e, b); });
    const auto [from, is_new] = known.try_emplace(corners);
    if (is_new) from->second = nodes_in_order(mesh.order(), corners);
    for (Eigen::Index a = 0; a < sorted.cols(); ++a) sorted(e, a) = mesh.elements(e, from->second[a]);
  }
  return sorted;
}

struct Parts {
  Indices numbers;  // E x kinds: of each element's edges, or of its faces
  int count = 0;
};

template <std::size_t kCorners, std::size_t kKinds>
Parts number_parts(const Indices& elements, const std::array<std::array<int, kCorners>, kKinds>& kinds) {
  using Part = std::array<std::int32_t, kCorners>;
  std::vector<Part> all;
  all.reserve(kKinds * static_cast<std::size_t>(elements.rows()));
  for (Eigen::Index e = 0; e < elements.rows(); ++e) {
    for (const auto& kind : kinds) {
      Part& part = all.emplace_back();
      for (std::size_t i = 0; i < kCorners; ++i) part[i] = elements(e, kind[i]);
    }
  }
  std::vector<Part> unique = all;
  std::sort(unique.begin(), unique.end());
  unique.erase(std::unique(unique.begin(), unique.end()), unique.end());
  Parts parts{Indices(elements.rows(), kKinds), static_cast<int>(unique.size())};
  std::transform(all.begin(), all.end(), parts.numbers.data(), [&](const Part& part) {
    return static_cast<std::int32_t>(std::lower_bound(unique.begin(), unique.end(), part) - unique.begin());
  });
  return parts;
}

}  // namespace

SurplusSpace surplus_space(const TetMesh& mesh) {
  SurplusSpace space;
  space.nodes = with_rising_corners(mesh);
  const auto elements = static_cast<int>(space.nodes.rows());
  const Parts edges = number_parts(space.nodes, kRisingEdges), faces = number_parts(space.nodes, kRisingFaces);
  const int per_face = surplus_per_face(mesh.order()), inside = surplus_inside(mesh.order());
  const int first_of_faces = edges.count, first_inside = first_of_faces + per_face * faces.count;

  space.functions.resize(elements, surplus_per_element(mesh.order()));
  for (int e = 0; e < elements; ++e) {
    std::int32_t* function = space.functions.row(e).data();
    for (const std::int32_t edge : edges.numbers.row(e)) *function++ = edge;
    for (const std::int32_t face : faces.numbers.row(e)) {
      for (int k = 0; k < per_face; ++k) *function++ = first_of_faces + per_face * face + k;
    }
    for (int k = 0; k < inside; ++k) *function++ = first_inside + inside * e + k;
  }

  for (int edge = 0; edge < edges.count; ++edge) space.parts.push_back(edge);
  for (int face = 0; per_face > 0 && face < faces.count; ++face) {
    space.parts.push_back(first_of_faces + per_face * face);
  }
  for (int e = 0; inside > 0 && e < elements; ++e) space.parts.push_back(first_inside + inside * e);
  space.parts.push_back(first_inside + inside * elements);
  return space;
}

}  // namespace ringdown::mesh
