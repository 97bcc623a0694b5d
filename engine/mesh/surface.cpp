#include "engine/mesh/surface.h"

#include <Eigen/Geometry>
#include <meshoptimizer.h>

#include <algorithm>
#include <cassert>
#include <numeric>
#include <string>

namespace ringdown::mesh {
namespace {

using Triangle = std::array<std::int32_t, 3>;

// The same turn of the face, its lowest number first.
Triangle lowest_first(Triangle face) {
  std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  return face;
}

Triangle sorted(Triangle face) {
  std::sort(face.begin(), face.end());
  return face;
}

Surface number_points(const std::vector<Triangle>& faces) {
  Surface surface;
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

std::vector<Triangle> faces_of(const Surface& surface, const std::vector<std::uint32_t>& indices) {
  std::vector<Triangle> faces;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    faces.push_back(
        lowest_first({surface.nodes[indices[i]], surface.nodes[indices[i + 1]], surface.nodes[indices[i + 2]]}));
  }
  return faces;
}

std::vector<std::uint32_t> simplify(const Surface& surface, const Points& nodes, std::size_t target_indices,
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

Surface boundary_surface(const TetMesh& mesh) {
  std::vector<std::pair<Triangle, Triangle>> faces;  // by its sorted nodes; as seen from outside
  faces.reserve(4 * static_cast<std::size_t>(mesh.elements.rows()));
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    for (const auto& [a, b, c] : kTetFaces) {
      const Triangle face = {mesh.elements(e, a), mesh.elements(e, b), mesh.elements(e, c)};
      faces.emplace_back(sorted(face), lowest_first(face));
    }
  }
  std::sort(faces.begin(), faces.end());
  std::vector<Triangle> outer;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t next = i + 1;
    while (next < faces.size() && faces[next].first == faces[i].first) ++next;
    if (next == i + 1) outer.push_back(faces[i].second);
    i = next;
  }
  return number_points(outer);
}

Result<Surface> decimate(const Surface& surface, const Points& nodes, std::size_t most_points) {
  assert(most_points >= 4);
  // A closed surface has about two triangles for each point. Collapsing stops at whole triangles, so ask for
  // fewer until the points fit; give up the topology only when keeping it does not let them.
  for (const bool keep_topology : {true, false}) {
    std::size_t target = 2 * most_points;
    Surface smaller = surface;
    for (int attempt = 0; attempt < 12 && target >= 4; ++attempt) {
      if (!smaller.triangles.empty() && smaller.nodes.size() <= most_points) return smaller;
      smaller = number_points(faces_of(surface, simplify(surface, nodes, 3 * target, keep_topology)));
      target = target * 9 / 10;
    }
    if (!smaller.triangles.empty() && smaller.nodes.size() <= most_points) return smaller;
  }
  return fail("the surface of " + std::to_string(surface.nodes.size()) + " points cannot be reduced to " +
              std::to_string(most_points) + "; allow more points");
}

std::vector<double> area_weights(const Surface& surface, const Points& nodes) {
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
