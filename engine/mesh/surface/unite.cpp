#include "engine/mesh/surface/unite.h"

#include "engine/base/groups.h"
#include "engine/mesh/files/surface_file.h"
#include "engine/mesh/stuffing/winding_number.h"
#include "engine/mesh/surface/arrangement.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

// The skin of a union
//
// The surface is cut wherever it meets itself (arrangement.h). Parts connected through edges that no further part
// touches form a patch. The winding number is constant in front of a patch; behind the patch it is larger by the
// patch's layers. The number is computed on both sides of the largest triangle of each patch, close to the triangle. If
// the difference is not the number of layers, another part of the surface lies between, and closer points are tried,
// then the next smaller triangles. A patch belongs to the skin if the number is below one half in front of it and above
// one half behind it. Source: G. Barill, N. G. Dickson, R. Schmidt, D. I. W. Levin & A. Jacobson, Fast Winding Numbers
// for Soups and Clouds, ACM Trans. Graph. 37(4), 2018, section 5.
namespace ringdown::mesh {
namespace {

using Eigen::Vector3d;

class Skin {
 public:
  Skin(const TriangleMesh& surface, const Arrangement& parts)
      : winding_(surface), parts_(parts), patches_(parts.layers.size()) {}

  TriangleMesh run() {
    link();
    std::vector<std::vector<std::size_t>> members(parts_.layers.size());
    for (std::size_t t = 0; t < parts_.layers.size(); ++t) members[patches_.root(t)].push_back(t);
    TriangleMesh skin{.nodes = parts_.mesh.nodes, .triangles = parts_.mesh.triangles};
    Eigen::Index kept = 0;
    for (std::vector<std::size_t>& patch : members) {
      if (patch.empty() || !is_skin(patch)) continue;
      for (const std::size_t t : patch) skin.triangles.row(kept++) = parts_.mesh.triangles.row(index(t));
    }
    skin.triangles.conservativeResize(kept, 3);
    return skin;
  }

 private:
  static Eigen::Index index(std::size_t t) { return static_cast<Eigen::Index>(t); }

  void link() {
    const std::vector<EdgeUse> edges = edges_of(parts_.mesh, std::vector<bool>(parts_.layers.size(), true));
    for (std::size_t first = 0, last; first < edges.size(); first = last) {
      last = end_of_edge(edges, first);
      const auto a = static_cast<std::size_t>(edges[first].triangle);
      const auto b = static_cast<std::size_t>(edges[last - 1].triangle);
      const bool agree = last - first == 2 && edges[first].forward != edges[last - 1].forward;
      if (agree && parts_.layers[a] == parts_.layers[b]) patches_.join_to(a, b);
    }
  }

  [[nodiscard]] Vector3d corner(std::size_t t, int i) const {
    return parts_.mesh.nodes.row(parts_.mesh.triangles(index(t), i)).transpose();
  }
  [[nodiscard]] Vector3d area(std::size_t t) const {
    const Vector3d a = corner(t, 0);
    return (corner(t, 1) - a).cross(corner(t, 2) - a) / 2;
  }

  bool is_skin(std::vector<std::size_t>& patch) const {
    constexpr std::size_t kTries = 5;
    const std::size_t tries = std::min(kTries, patch.size());
    std::partial_sort(patch.begin(), patch.begin() + static_cast<std::ptrdiff_t>(tries), patch.end(),
                      [this](std::size_t a, std::size_t b) { return area(a).norm() > area(b).norm(); });
    const double layers = parts_.layers[patch.front()];
    double front = 0, behind = 0;
    for (std::size_t i = 0; i < tries; ++i) {
      if (find_numbers(patch[i], layers, front, behind)) break;
    }
    return front < 0.5 && behind >= 0.5;
  }

  // Computes the winding numbers on both sides of triangle `t`. Returns false if they do not differ by the layers. No
  // point fits between two sheets that face opposite ways and lie within rounding of each other. Both sheets then get
  // the numbers around the pair, so that both are kept or neither. A mean of the two sides would be one half there, and
  // rounding would decide.
  bool find_numbers(std::size_t t, double layers, double& front, double& behind) const {
    const Vector3d twice = 2 * area(t), a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    const double height = twice.norm() / std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const double sign = winding_.turned() ? -1 : 1;
    const Vector3d middle = (a + b + c) / 3, normal = twice.normalized();
    for (const double step : {1e-2, 1e-4, 1e-6}) {
      front = sign * winding_.at(middle + step * height * normal, 1e-2);
      behind = sign * winding_.at(middle - step * height * normal, 1e-2);
      if (std::abs(behind - front - layers) < 0.2) return true;
    }
    return false;
  }

  WindingNumber winding_;
  const Arrangement& parts_;
  Groups<> patches_;  // of parts
};

}  // namespace

Result<TriangleMesh> unite(const TriangleMesh& mesh) {
  const Result<Arrangement> parts = arrange(mesh);
  if (!parts) return fail(parts);
  TriangleMesh skin = Skin(mesh, *parts).run();
  drop_unused_nodes(skin);
  return weld(skin, kMergeShare * diagonal_of(skin));
}

}  // namespace ringdown::mesh
