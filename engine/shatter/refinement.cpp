#include "engine/shatter/refinement.h"

#include <algorithm>
#include <bit>
#include <unordered_map>
#include <utility>

namespace ringdown::shatter {
namespace {

struct SimplexHash {
  std::size_t operator()(const Simplex& simplex) const {
    std::uint64_t hash = 0;
    for (const std::int32_t corner : simplex) {
      hash = (hash ^ static_cast<std::uint32_t>(corner)) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

}  // namespace

Simplex simplex_of(std::array<std::int32_t, 4> corners, int count) {
  std::fill(corners.begin() + count, corners.end(), -1);
  std::sort(corners.begin(), corners.begin() + count);
  return corners;
}

Simplex simplex_of(const SubElement& element, int subset) {
  std::array<std::int32_t, 4> corners{};
  int count = 0;
  for (int c = 0; c < 4; ++c) {
    if (subset >> c & 1) corners[count++] = element.corners[c];
  }
  return simplex_of(corners, count);
}

std::vector<int> corner_subsets(int count) {
  std::vector<int> subsets;
  for (unsigned bits = 1; bits < 16; ++bits) {
    if (std::popcount(bits) == count) subsets.push_back(static_cast<int>(bits));
  }
  return subsets;
}

std::vector<Simplex> unique(std::vector<Simplex> simplices) {
  std::sort(simplices.begin(), simplices.end());
  simplices.erase(std::unique(simplices.begin(), simplices.end()), simplices.end());
  return simplices;
}

Refinement::Refinement(std::vector<SubElement> elements, mesh::Points points) : elements_(std::move(elements)) {
  for (const auto& point : points.rowwise()) points_.emplace_back(point.transpose());
}

Refinement::Refinement(const mesh::TetMesh& body) {
  mesh::Points nodes = body.nodes;
  mesh::Indices corners = body.elements.leftCols(4);
  mesh::drop_unused_nodes(nodes, corners);
  for (const auto& node : nodes.rowwise()) points_.emplace_back(node.transpose());
  for (Eigen::Index e = 0; e < corners.rows(); ++e) {
    SubElement& element = elements_.emplace_back();
    for (int c = 0; c < 4; ++c) element.corners[c] = corners(e, c);
    element.parent = static_cast<std::int32_t>(e);
    element.barycentric.setIdentity();
  }
}

Refinement Refinement::of_elements(const Refinement& other) {
  Refinement own = other;
  for (std::size_t e = 0; e < own.elements_.size(); ++e) {
    own.elements_[e].parent = static_cast<std::int32_t>(e);
    own.elements_[e].barycentric.setIdentity();
  }
  return own;
}

// Several insertions into one tetrahedron
//
// A tetrahedron takes the insertion of the lowest rank first; its children are looked up again, because they have the
// other edges or faces of the tetrahedron. The face between two tetrahedra is divided by the ranks of its own edges
// alone, so both divide it in one way.
void Refinement::insert(std::vector<Insertion>& insertions, int count) {
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t k = 0; k < insertions.size(); ++k) {
    Insertion& insertion = insertions[k];
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    for (int c = 0; c < count; ++c) at += insertion.weights[c] * points_[insertion.simplex[c]];
    insertion.point = static_cast<std::int32_t>(points_.size());
    points_.push_back(at);
    ranked.emplace_back(-(points_[insertion.simplex[0]] - points_[insertion.simplex[1]]).squaredNorm(), k);
  }
  std::sort(ranked.begin(), ranked.end());
  std::unordered_map<Simplex, std::size_t, SimplexHash> rank_of;  // positions in `ranked`
  for (std::size_t rank = 0; rank < ranked.size(); ++rank) rank_of[insertions[ranked[rank].second].simplex] = rank;

  std::vector<SubElement> finished, waiting;
  finished.reserve(elements_.size());
  const std::vector<int> subsets = corner_subsets(count);
  for (const SubElement& whole : elements_) {
    waiting.push_back(whole);
    while (!waiting.empty()) {
      const SubElement element = waiting.back();
      waiting.pop_back();
      std::size_t first = ranked.size();
      for (const int subset : subsets) {
        const auto found = rank_of.find(simplex_of(element, subset));
        if (found != rank_of.end()) first = std::min(first, found->second);
      }
      if (first == ranked.size()) {
        finished.push_back(element);
        continue;
      }
      const Insertion& insertion = insertions[ranked[first].second];
      std::array<int, 4> places{};
      Eigen::RowVector4d at = Eigen::RowVector4d::Zero();
      for (int k = 0; k < count; ++k) {
        places[k] = static_cast<int>(std::find(element.corners.begin(), element.corners.end(), insertion.simplex[k]) -
                                     element.corners.begin());
        at += insertion.weights[k] * element.barycentric.row(places[k]);
      }
      for (int k = 0; k < count; ++k) {
        SubElement& child = waiting.emplace_back(element);
        child.corners[places[k]] = insertion.point;
        child.barycentric.row(places[k]) = at;
      }
    }
  }
  elements_ = std::move(finished);
}

}  // namespace ringdown::shatter
