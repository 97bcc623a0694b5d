#include "engine/mesh/boundary.h"

#include <Eigen/Geometry>
#include <meshoptimizer.h>

#include <algorithm>
#include <cassert>
#include <numeric>
#include <string>

// From a solid to the points of a bank
//
// All faces of all elements are sorted by their corners; a face that stands there once belongs to the boundary. Its
// nodes, those between the corners included, become flat triangles (parts_of_face()). decimate() then collapses edges
// onto existing points until few enough are left: it asks for ever fewer triangles, first with the topology kept, and
// when that does not go far enough, without.
namespace ringdown::mesh {
namespace {

using Triangle = std::array<std::int32_t, 3>;

// The face, turned the same way round, with its lowest number first.
Triangle lowest_first(Triangle face) {
  std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  return face;
}

Triangle sorted(Triangle face) {
  std::sort(face.begin(), face.end());
  return face;
}

// The p^2 triangles between an element's nodes on one of its faces, turned as kTetFaces turns it.
std::vector<Triangle> parts_of_face(int order, int face) {
  const auto node_at = [&](int i, int j, int k) {  // shares of the face's corners, p in all
    Barycentric place = Barycentric::Zero(1, 4);
    place(kTetFaces[face][0]) = i;
    place(kTetFaces[face][1]) = j;
    place(kTetFaces[face][2]) = k;
    return nodes_at(order, place / order)[0];
  };
  std::vector<Triangle> parts;
  for (int i = 0; i < order; ++i) {
    for (int j = 0; i + j < order; ++j) {
      const int k = order - 1 - i - j;
      parts.push_back({node_at(i + 1, j, k), node_at(i, j + 1, k), node_at(i, j, k + 1)});
      if (k > 0) parts.push_back({node_at(i + 1, j + 1, k - 1), node_at(i, j + 1, k), node_at(i + 1, j, k)});
    }
  }
  return parts;
}

Boundary number_points(const std::vector<Triangle>& faces) {
  Boundary surface;
  for (const Triangle& face : faces) surface.nodes.insert(surface.nodes.end(), face.begin(), face.end());
  std::sort(surface.nodes.begin(), surface.nodes.end());
  surface.nodes.erase(std::unique(surface.nodes.begin(), surface.nodes.end()), surface.nodes.end());
  const auto position = [&](std::int32_t node) {
    return static_cast<std::uint32_t>(std::lower_bound(surface.nodes.begin(), surface.nodes.end(), node) -
                                      surface.nodes.begin());
  };
  for (const Triangle& face : faces) {
    surface.triangles.push_back({position(face[0]), position(face[1]), position(face[2])});
  }
  return surface;
}

std::vector<Triangle> faces_of(const Boundary& surface, const std::vector<std::uint32_t>& indices) {
  std::vector<Triangle> faces;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    faces.push_back(
        lowest_first({surface.nodes[indices[i]], surface.nodes[indices[i + 1]], surface.nodes[indices[i + 2]]}));
  }
  return faces;
}

std::vector<std::uint32_t> simplify(const Boundary& surface, const Points& nodes, std::size_t target_indices,
                                    bool keep_topology) {
  std::vector<float> positions;
  for (const std::int32_t node : surface.nodes) {
    for (int axis = 0; axis < 3; ++axis) positions.push_back(static_cast<float>(nodes(node, axis)));
  }
  std::vector<std::uint32_t> indices;
  for (const auto& triangle : surface.triangles) indices.insert(indices.end(), triangle.begin(), triangle.end());
  std::vector<std::uint32_t> fewer(indices.size());
  constexpr std::size_t kStride = 3 * sizeof(float);
  constexpr float kAnyError = 1e9f;
  const std::size_t count = keep_topology
                                ? meshopt_simplify(fewer.data(), indices.data(), indices.size(), positions.data(),
                                                   surface.nodes.size(), kStride, target_indices, kAnyError)
                                : meshopt_simplifySloppy(fewer.data(), indices.data(), indices.size(), positions.data(),
                                                         surface.nodes.size(), kStride, target_indices, kAnyError);
  fewer.resize(count);
  return fewer;
}

}  // namespace

Boundary boundary_of(const TetMesh& mesh) {
  struct Face {
    Triangle corners;  // sorted
    Eigen::Index element;
    int opposite;
  };
  std::vector<Face> faces;
  faces.reserve(4 * static_cast<std::size_t>(mesh.elements.rows()));
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    for (int f = 0; f < 4; ++f) {
      const auto& [a, b, c] = kTetFaces[f];
      faces.push_back({sorted({mesh.elements(e, a), mesh.elements(e, b), mesh.elements(e, c)}), e, f});
    }
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.corners < b.corners; });
  std::array<std::vector<Triangle>, 4> parts;
  for (int f = 0; f < 4; ++f) parts[f] = parts_of_face(mesh.order(), f);
  std::vector<Triangle> outer;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t next = i + 1;
    while (next < faces.size() && faces[next].corners == faces[i].corners) ++next;
    if (next == i + 1) {
      const auto element = mesh.elements.row(faces[i].element);
      for (const auto& [a, b, c] : parts[faces[i].opposite]) {
        outer.push_back(lowest_first({element[a], element[b], element[c]}));
      }
    }
    i = next;
  }
  return number_points(outer);
}

Result<Boundary> decimate(const Boundary& surface, const Points& nodes, std::size_t most_points) {
  assert(most_points >= 4);
  // A closed surface has about two triangles for each point. Collapsing stops at whole triangles, so ask for
  // fewer until the points fit; give up the topology only when keeping it does not let them.
  for (const bool keep_topology : {true, false}) {
    std::size_t target = 2 * most_points;
    Boundary smaller = surface;
    for (int attempt = 0; attempt < 12 && target >= 4; ++attempt) {
      if (!smaller.triangles.empty() && smaller.nodes.size() <= most_points) return smaller;
      smaller = number_points(faces_of(surface, simplify(surface, nodes, 3 * target, keep_topology)));
      target = target * 9 / 10;
    }
    if (!smaller.triangles.empty() && smaller.nodes.size() <= most_points) return smaller;
  }
  return fail(ErrorKind::too_large, "the surface of " + std::to_string(surface.nodes.size()) +
                                        " points cannot be reduced to " + std::to_string(most_points) +
                                        "; allow more points");
}

std::vector<double> area_weights(const Boundary& surface, const Points& nodes) {
  std::vector<double> weights(surface.nodes.size(), 0.0);
  for (const auto& triangle : surface.triangles) {
    const Eigen::Vector3d a = nodes.row(surface.nodes[triangle[0]]), b = nodes.row(surface.nodes[triangle[1]]),
                          c = nodes.row(surface.nodes[triangle[2]]);
    for (const std::uint32_t point : triangle) weights[point] += (b - a).cross(c - a).norm();
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

}  // namespace ringdown::mesh
