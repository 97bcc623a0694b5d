#include "engine/shatter/piece_mesh.h"

#include "engine/base/groups.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <utility>

// Numbering the nodes
//
// A point of the cut body becomes one node for each fan of parts around it: parts that are connected through faces at
// the point. Parts that touch in an edge only may be in one fan at both of its ends; then the edge is divided, and its
// new middle has two fans.
namespace ringdown::shatter {
namespace {

struct Slot {
  Simplex simplex;
  std::size_t element;
  int subset;
};

// All simplices of `count` corners of all elements, equal ones adjacent.
std::vector<Slot> sorted_slots(const std::vector<SubElement>& elements, int count) {
  std::vector<Slot> slots;
  const std::vector<int> subsets = corner_subsets(count);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    for (const int subset : subsets) slots.push_back({simplex_of(elements[e], subset), e, subset});
  }
  std::sort(slots.begin(), slots.end(), [](const Slot& a, const Slot& b) {
    return a.simplex != b.simplex ? a.simplex < b.simplex : a.element < b.element;
  });
  return slots;
}

// The subset of an element's corners that a simplex has.
int subset_in(const SubElement& element, const Simplex& simplex) {
  int subset = 0;
  for (int c = 0; c < 4; ++c) {
    if (std::find(simplex.begin(), simplex.end(), element.corners[c]) != simplex.end()) subset |= 1 << c;
  }
  return subset;
}

// Groups of (element, subset of its corners), 16 for each element: connected through faces that have the simplex.
Groups<> fans_of(const std::vector<SubElement>& elements) {
  Groups<> fans(16 * elements.size());
  const std::vector<Slot> faces = sorted_slots(elements, 3);
  for (std::size_t k = 1; k < faces.size(); ++k) {
    const Slot &a = faces[k - 1], &b = faces[k];
    if (a.simplex != b.simplex) continue;
    for (int count = 1; count < 3; ++count) {
      for (const int subset : corner_subsets(count)) {
        if ((subset & a.subset) != subset) continue;
        const Simplex simplex = simplex_of(elements[a.element], subset);
        fans.join(16 * a.element + static_cast<std::size_t>(subset),
                  16 * b.element + static_cast<std::size_t>(subset_in(elements[b.element], simplex)));
      }
    }
  }
  return fans;
}

// Gives each fan around a point a number of its own; returns the point of each number.
std::vector<std::int32_t> part_points(std::vector<SubElement>& elements, Groups<>& fans) {
  std::vector<std::pair<std::int32_t, std::size_t>> nodes;  // point, root
  for (std::size_t e = 0; e < elements.size(); ++e) {
    for (int c = 0; c < 4; ++c) nodes.emplace_back(elements[e].corners[c], fans.root(16 * e + (std::size_t{1} << c)));
  }
  std::vector<std::pair<std::int32_t, std::size_t>> numbered = nodes;
  std::sort(numbered.begin(), numbered.end());
  numbered.erase(std::unique(numbered.begin(), numbered.end()), numbered.end());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto found = std::lower_bound(numbered.begin(), numbered.end(), nodes[k]);
    elements[k / 4].corners[k % 4] = static_cast<std::int32_t>(found - numbered.begin());
  }
  std::vector<std::int32_t> points;
  points.reserve(numbered.size());
  for (const auto& [point, root] : numbered) points.push_back(point);
  return points;
}

// Edges with more than one fan around them.
std::vector<Insertion> pinched_edges(const std::vector<SubElement>& elements, Groups<>& fans) {
  std::vector<Insertion> found;
  const std::vector<Slot> edges = sorted_slots(elements, 2);
  const auto fan = [&](const Slot& slot) {
    return fans.root(16 * slot.element + static_cast<std::size_t>(slot.subset));
  };
  for (std::size_t k = 1; k < edges.size(); ++k) {
    const Slot &a = edges[k - 1], &b = edges[k];
    if (a.simplex != b.simplex || fan(a) == fan(b)) continue;
    if (found.empty() || found.back().simplex != a.simplex) found.push_back({a.simplex, {0.5, 0.5, 0, 0}});
  }
  return found;
}

mesh::Points gather(const mesh::Points& points, const std::vector<std::int32_t>& numbers) {
  mesh::Points gathered(static_cast<Eigen::Index>(numbers.size()), 3);
  for (std::size_t k = 0; k < numbers.size(); ++k) gathered.row(static_cast<Eigen::Index>(k)) = points.row(numbers[k]);
  return gathered;
}

}  // namespace

PieceMesh piece_mesh(const CutBody& cut, const mesh::TetMesh& body, const std::vector<std::int64_t>& elements) {
  std::vector<SubElement> parts;
  parts.reserve(elements.size());
  for (const std::int64_t element : elements) parts.push_back(cut.elements[static_cast<std::size_t>(element)]);
  Groups fans = fans_of(parts);
  mesh::Points points = gather(cut.points, part_points(parts, fans));
  fans = fans_of(parts);
  if (std::vector<Insertion> pinched = pinched_edges(parts, fans); !pinched.empty()) {
    Refinement refinement(std::move(parts), points);
    refinement.insert(pinched, 2);
    parts = refinement.elements();
    points.resize(refinement.point_count(), 3);
    for (Eigen::Index k = 0; k < points.rows(); ++k) points.row(k) = refinement.point(k).transpose();
    fans = fans_of(parts);
    points = gather(points, part_points(parts, fans));
  }

  mesh::TetMesh straight{std::move(points), mesh::Indices(static_cast<Eigen::Index>(parts.size()), 4)};
  for (std::size_t e = 0; e < parts.size(); ++e) {
    for (int c = 0; c < 4; ++c) straight.elements(static_cast<Eigen::Index>(e), c) = parts[e].corners[c];
  }
  const int order = body.order();
  PieceMesh piece{mesh::to_order(straight, order), {}, {}};
  const Eigen::Index count = piece.mesh.nodes.rows();
  piece.parent.assign(static_cast<std::size_t>(count), -1);
  piece.barycentric.resize(count, 4);
  const mesh::Barycentric inside = mesh::reference_nodes(order);
  for (std::size_t e = 0; e < parts.size(); ++e) {
    const mesh::ElementNodes whole = mesh::nodes_of(body, parts[e].parent);
    for (Eigen::Index a = 0; a < inside.rows(); ++a) {
      const std::int32_t node = piece.mesh.elements(static_cast<Eigen::Index>(e), a);
      if (piece.parent[node] >= 0) continue;
      piece.parent[node] = parts[e].parent;
      piece.barycentric.row(node) = inside.row(a) * parts[e].barycentric;
      const Eigen::VectorXd shares = mesh::interpolation(order, piece.barycentric.row(node).transpose());
      piece.mesh.nodes.row(node) = shares.transpose() * whole;
    }
  }
  piece.parts = std::move(parts);
  return piece;
}

Eigen::MatrixXd restricted(const PieceMesh& piece, const mesh::TetMesh& body, const Eigen::MatrixXd& shapes) {
  assert(shapes.rows() == 3 * body.nodes.rows());
  Eigen::MatrixXd fields = Eigen::MatrixXd::Zero(3 * piece.barycentric.rows(), shapes.cols());
  for (Eigen::Index node = 0; node < piece.barycentric.rows(); ++node) {
    const Eigen::VectorXd shares = mesh::interpolation(body.order(), piece.barycentric.row(node).transpose());
    const auto whole = body.elements.row(piece.parent[node]);
    for (Eigen::Index a = 0; a < shares.size(); ++a) {
      fields.middleRows<3>(3 * node) += shares[a] * shapes.middleRows<3>(3 * Eigen::Index{whole[a]});
    }
  }
  return fields;
}

// Each node belongs to the element of the coarser piece that reaches farthest around a place beside the node, inside
// the node's own element. Elements that only touch each other have nodes of their own, so the node itself would not
// tell them apart.
Eigen::MatrixXd restricted(const PieceMesh& piece, const PieceMesh& coarser, const Eigen::MatrixXd& shapes) {
  constexpr double kBeside = 0.01;  // the share of the way to the middle of the node's element
  assert(shapes.rows() == 3 * coarser.mesh.nodes.rows());
  std::vector<std::pair<std::int32_t, std::size_t>> by_parent;  // a body's element, and the number of a part of it
  std::vector<Eigen::Matrix4d> to_own(coarser.parts.size());
  for (std::size_t e = 0; e < coarser.parts.size(); ++e) {
    by_parent.emplace_back(coarser.parts[e].parent, e);
    to_own[e] = coarser.parts[e].barycentric.inverse();
  }
  std::sort(by_parent.begin(), by_parent.end());
  const int order = coarser.mesh.order();
  const mesh::Barycentric inside = mesh::reference_nodes(order);
  const Eigen::RowVector4d middle = Eigen::RowVector4d::Constant(0.25);
  Eigen::MatrixXd fields = Eigen::MatrixXd::Zero(3 * piece.mesh.nodes.rows(), shapes.cols());
  std::vector<bool> done(static_cast<std::size_t>(piece.mesh.nodes.rows()), false);
  for (std::size_t e = 0; e < piece.parts.size(); ++e) {
    const SubElement& own = piece.parts[e];
    const auto candidates =
        std::ranges::equal_range(by_parent, own.parent, {}, &decltype(by_parent)::value_type::first);
    for (Eigen::Index a = 0; a < inside.rows(); ++a) {
      const std::int32_t node = piece.mesh.elements(static_cast<Eigen::Index>(e), a);
      if (done[node]) continue;
      done[node] = true;
      const Eigen::RowVector4d place = inside.row(a) * own.barycentric;
      const Eigen::RowVector4d beside = place + kBeside * (middle * own.barycentric - place);
      const auto reach = [&](const auto& candidate) { return (beside * to_own[candidate.second]).minCoeff(); };
      assert(!candidates.empty());
      const std::size_t part = std::ranges::max_element(candidates, {}, reach)->second;
      const Eigen::VectorXd shares = mesh::interpolation(order, (place * to_own[part]).transpose());
      const auto whole = coarser.mesh.elements.row(static_cast<Eigen::Index>(part));
      for (Eigen::Index k = 0; k < shares.size(); ++k)
        fields.middleRows<3>(3 * Eigen::Index{node}) += shares[k] * shapes.middleRows<3>(3 * Eigen::Index{whole[k]});
    }
  }
  return fields;
}

}  // namespace ringdown::shatter
