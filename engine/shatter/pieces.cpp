#include "engine/shatter/pieces.h"

#include "engine/shatter/part_graph.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>

namespace ringdown::shatter {
namespace {

// The volume of each of the body's elements, curved as it is.
std::vector<double> element_volumes(const mesh::TetMesh& body) {
  std::vector<double> volumes_m3(static_cast<std::size_t>(body.elements.rows()), 0);
  const int order = body.order();
  for (const mesh::QuadraturePoint& point : mesh::tet_quadrature(std::max(3 * (order - 1), 1))) {
    const mesh::ReferenceGradient gradient = mesh::interpolation_gradient(order, point.barycentric);
    for (Eigen::Index e = 0; e < body.elements.rows(); ++e) {
      volumes_m3[static_cast<std::size_t>(e)] +=
          point.weight * mesh::jacobian(mesh::nodes_of(body, e), gradient).determinant() / 6;
    }
  }
  return volumes_m3;
}

PartGraph graph_of(const CutBody& cut, const mesh::TetMesh& body) {
  PartGraph graph;
  const std::vector<double> whole_m3 = element_volumes(body);
  std::vector<std::pair<Simplex, std::int32_t>> faces;
  for (std::size_t e = 0; e < cut.elements.size(); ++e) {
    const SubElement& element = cut.elements[e];
    graph.volumes_m3.push_back(element.barycentric.determinant() * whole_m3[element.parent]);
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    for (const std::int32_t corner : element.corners) place += 0.25 * cut.points.row(corner).transpose();
    graph.places.push_back(place);
    for (const int subset : corner_subsets(3)) {
      faces.emplace_back(simplex_of(element, subset), static_cast<std::int32_t>(e));
    }
  }
  std::sort(faces.begin(), faces.end());
  for (std::size_t k = 1; k < faces.size(); ++k) {
    if (faces[k - 1].first != faces[k].first) continue;
    const Simplex& face = faces[k].first;
    const Eigen::Vector3d from = cut.points.row(face[0]);
    const Eigen::Vector3d u = cut.points.row(face[1]).transpose() - from,
                          v = cut.points.row(face[2]).transpose() - from;
    graph.joints.push_back({faces[k - 1].second, faces[k].second, 0.5 * u.cross(v).norm()});
  }
  return graph;
}

double crack_area_m2(const PartGraph& graph, const Parts& parts) {
  double sum_m2 = 0;
  for (const auto& [a, b, area_m2] : graph.joints) sum_m2 += parts[a] == parts[b] ? 0 : area_m2;
  return sum_m2;
}

Level level_of(const PartGraph& graph, Parts parts) {
  Level level;
  for (const double volume_m3 : volumes_of(graph, parts))
    level.pieces.push_back({.volume_m3 = volume_m3, .coarser = -1, .crack_area_m2 = 0});
  level.crack_area_m2 = crack_area_m2(graph, parts);
  level.piece_of_element = std::move(parts);
  return level;
}

// Adds the cracks of the finer level to those pieces of the coarser one that they divide.
void add_inner_cracks(const PartGraph& graph, const Level& finer, Level& coarser) {
  for (const auto& [a, b, area_m2] : graph.joints) {
    const std::int32_t piece = coarser.piece_of_element[a];
    if (piece == coarser.piece_of_element[b] && finer.piece_of_element[a] != finer.piece_of_element[b])
      coarser.pieces[piece].crack_area_m2 += area_m2;
  }
}

}  // namespace

// Levels are found from the finest to the coarsest. The bits of the finest level are elements; those of each other
// level are the pieces of the finer one, each labelled with the group that most of its volume belongs to.
std::vector<Level> levels_of(const CutBody& cut, const mesh::TetMesh& body,
                             const std::vector<std::vector<std::int32_t>>& group_of_cell, double min_volume_share) {
  assert(!group_of_cell.empty());
  const PartGraph elements = graph_of(cut, body);
  double body_m3 = 0;
  for (const double volume_m3 : elements.volumes_m3) body_m3 += volume_m3;

  std::vector<Level> levels(group_of_cell.size());
  PartGraph graph = elements;
  Parts bit_of_element(cut.elements.size());
  for (std::size_t e = 0; e < bit_of_element.size(); ++e) bit_of_element[e] = static_cast<std::int32_t>(e);
  std::vector<std::int32_t> cells = cut.cell;  // of each bit; after the finest level, those of most of its volume
  for (std::size_t level = levels.size(); level-- > 0;) {
    std::vector<std::int32_t> labels, families;
    for (const std::int32_t cell : cells) {
      labels.push_back(group_of_cell[level][cell]);
      families.push_back(level > 0 ? group_of_cell[level - 1][cell] : 0);
    }
    const Parts whole = parted_at_necks(graph, connected_parts(graph, labels));
    const Parts parts = joined_small(graph, whole, families, min_volume_share * body_m3);
    Parts part_of_element;
    for (const std::int32_t bit : bit_of_element) part_of_element.push_back(parts[bit]);
    levels[level] = level_of(elements, part_of_element);
    if (level + 1 < levels.size()) {
      for (std::size_t bit = 0; bit < parts.size(); ++bit) levels[level + 1].pieces[bit].coarser = parts[bit];
    }
    cells = main_labels(graph, parts, cells);
    graph = merged(graph, parts);
    bit_of_element = std::move(part_of_element);
  }
  for (std::size_t level = 0; level + 1 < levels.size(); ++level)
    add_inner_cracks(elements, levels[level + 1], levels[level]);
  return levels;
}

std::vector<std::int64_t> elements_of(const Level& level, std::int32_t piece) {
  std::vector<std::int64_t> elements;
  for (std::size_t e = 0; e < level.piece_of_element.size(); ++e) {
    if (level.piece_of_element[e] == piece) elements.push_back(static_cast<std::int64_t>(e));
  }
  return elements;
}

}  // namespace ringdown::shatter
