#include "engine/radiate/panels.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>

namespace ringdown::radiate {
namespace {

// The position of a point along a curve that fills the box, from the interleaved bits of its three coordinates.
std::uint64_t place_on_curve(const Eigen::RowVector3d& inside_unit_box) {
  constexpr int kBits = 16;
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell = static_cast<std::uint64_t>(std::clamp(inside_unit_box[axis], 0.0, 1.0) * ((1 << kBits) - 1));
    for (int bit = 0; bit < kBits; ++bit) key |= (cell >> bit & 1) << (3 * bit + axis);
  }
  return key;
}

// For each old node, its new number along the space-filling curve, or -1 when no triangle has it.
std::vector<int> new_numbers(const mesh::TriangleMesh& surface) {
  const Eigen::RowVector3d low = surface.nodes.colwise().minCoeff();
  const double extent = std::max((surface.nodes.colwise().maxCoeff() - low).maxCoeff(), 1e-300);
  std::vector<bool> used(surface.nodes.rows(), false);
  for (Eigen::Index i = 0; i < surface.triangles.size(); ++i) used[surface.triangles.data()[i]] = true;
  std::vector<std::pair<std::uint64_t, int>> order;
  for (int n = 0; n < static_cast<int>(used.size()); ++n) {
    if (used[n]) order.emplace_back(place_on_curve((surface.nodes.row(n) - low) / extent), n);
  }
  std::sort(order.begin(), order.end());
  std::vector<int> number(used.size(), -1);
  for (std::size_t i = 0; i < order.size(); ++i) number[order[i].second] = static_cast<int>(i);
  return number;
}

Result<void> find_sides(Panels& panels) {
  struct Use {
    int low, high, triangle, opposite;
    bool forward;
  };
  std::vector<Use> uses;
  for (int t = 0; t < panels.triangle_count(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const int from = panels.corners[t][(i + 1) % 3], to = panels.corners[t][(i + 2) % 3];
      uses.push_back({std::min(from, to), std::max(from, to), t, i, from < to});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  panels.sides_of.resize(panels.corners.size());
  const auto same = [](const Use& a, const Use& b) { return a.low == b.low && a.high == b.high; };
  for (std::size_t i = 0; i < uses.size(); i += 2) {
    const bool on_plane = (panels.planes_at(uses[i].low) & panels.planes_at(uses[i].high)) != 0;
    const bool paired = i + 1 < uses.size() && same(uses[i], uses[i + 1]) && uses[i].forward != uses[i + 1].forward &&
                        (i + 2 >= uses.size() || !same(uses[i], uses[i + 2]));
    if (on_plane && (i + 1 == uses.size() || !same(uses[i], uses[i + 1]))) {
      Side side;
      side.nodes = {uses[i].low, uses[i].high, panels.corners[uses[i].triangle][uses[i].opposite], -1};
      side.triangles = {uses[i].triangle, -1};
      side.middle = (panels.nodes.row(uses[i].low) + panels.nodes.row(uses[i].high)).transpose() / 2;
      panels.sides_of[uses[i].triangle][uses[i].opposite] = panels.side_count();
      panels.sides.push_back(side);
      --i;  // the next use is the first one of another side
      continue;
    }
    if (!paired || on_plane)
      return fail(ErrorKind::bad_input, "the surface is not closed: a side has not just two triangles");
    Side side;
    side.nodes = {uses[i].low, uses[i].high, panels.corners[uses[i].triangle][uses[i].opposite],
                  panels.corners[uses[i + 1].triangle][uses[i + 1].opposite]};
    side.triangles = {uses[i].triangle, uses[i + 1].triangle};
    side.middle = (panels.nodes.row(uses[i].low) + panels.nodes.row(uses[i].high)).transpose() / 2;
    for (const Use& use : {uses[i], uses[i + 1]}) panels.sides_of[use.triangle][use.opposite] = panels.side_count();
    panels.sides.push_back(side);
  }
  return {};
}

}  // namespace

double Panels::longest_side(int triangle) const {
  double longest = 0;
  for (int i = 0; i < 3; ++i) longest = std::max(longest, (corner(triangle, i) - corner(triangle, (i + 1) % 3)).norm());
  return longest;
}

double Panels::area() const { return std::accumulate(areas.begin(), areas.end(), 0.0); }

double Panels::volume() const {
  double sum = 0;
  for (int t = 0; t < triangle_count(); ++t) sum += areas[t] * normals[t].dot(centers[t]) / 3;
  return sum;
}

Result<Panels> panels_of(const mesh::TriangleMesh& surface, int mirrors) {
  if (surface.triangles.rows() == 0) return fail(ErrorKind::bad_input, "the surface has no triangles");
  const std::vector<int> number = new_numbers(surface);
  Panels panels;
  panels.mirrors = mirrors;
  panels.nodes.resize(*std::max_element(number.begin(), number.end()) + 1, 3);
  for (std::size_t n = 0; n < number.size(); ++n) {
    if (number[n] >= 0) panels.nodes.row(number[n]) = surface.nodes.row(static_cast<Eigen::Index>(n));
  }
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto row = surface.triangles.row(t);
    panels.corners.push_back({number[row[0]], number[row[1]], number[row[2]]});
  }
  // Triangles are sorted by their lowest node, so sides with close numbers are close in space.
  std::sort(panels.corners.begin(), panels.corners.end(), [](const auto& a, const auto& b) {
    return std::pair(std::min({a[0], a[1], a[2]}), a) < std::pair(std::min({b[0], b[1], b[2]}), b);
  });
  for (int t = 0; t < panels.triangle_count(); ++t) {
    const Eigen::Vector3d a = panels.corner(t, 0), b = panels.corner(t, 1), c = panels.corner(t, 2);
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const double twice = normal.norm();
    if (!(twice > 0)) return fail(ErrorKind::bad_input, "the surface has a triangle without area");
    panels.areas.push_back(twice / 2);
    panels.normals.push_back(normal / twice);
    panels.centers.push_back((a + b + c) / 3);
    panels.curls.push_back({(b - c) / twice, (c - a) / twice, (a - b) / twice});
  }
  if (const auto found = find_sides(panels); !found) return fail(found);
  return panels;
}

mesh::TriangleMesh mesh_of(const Panels& panels) {
  mesh::TriangleMesh mesh;
  mesh.nodes = panels.nodes;
  mesh.triangles.resize(panels.triangle_count(), 3);
  for (int t = 0; t < panels.triangle_count(); ++t) {
    mesh.triangles.row(t) << panels.corners[t][0], panels.corners[t][1], panels.corners[t][2];
  }
  return mesh;
}

Hit nearest_hit(const Panels& panels, const Eigen::Vector3d& start, const Eigen::Vector3d& way, Face shown) {
  Hit nearest{std::numeric_limits<double>::infinity()};
  for (int t = 0; t < panels.triangle_count(); ++t) {
    const double along = panels.normals[t].dot(way);
    if (shown == Face::back ? along <= 0 : along >= 0) continue;
    const Eigen::Vector3d a = panels.corner(t, 0), e1 = panels.corner(t, 1) - a, e2 = panels.corner(t, 2) - a;
    const Eigen::Vector3d p = way.cross(e2), s = start - a, q = s.cross(e1);
    const double determinant = e1.dot(p), u = s.dot(p) / determinant, v = way.dot(q) / determinant;
    const double distance = e2.dot(q) / determinant;
    if (u >= 0 && v >= 0 && u + v <= 1 && distance > 0 && distance < nearest.distance_m) nearest = {distance, t};
  }
  return nearest;
}

int mirror_planes_at(const Eigen::Vector3d& point, int mirrors) {
  int planes = 0;
  for (int axis = 0; axis < mirrors; ++axis) planes |= point[axis] == 0 ? 1 << axis : 0;
  return planes;
}

Eigen::Vector3d image_of(const Eigen::Vector3d& point, int image) {
  Eigen::Vector3d mirrored = point;
  for (int axis = 0; axis < 3; ++axis) {
    if ((image >> axis & 1) != 0) mirrored[axis] = -mirrored[axis];
  }
  return mirrored;
}

// A curl is the cross product of a normal and a gradient, so it is mirrored and also changes its sign.
Panels image_of(const Panels& part, int image) {
  Panels mirrored = part;
  for (int n = 0; n < part.node_count(); ++n) {
    mirrored.nodes.row(n) = image_of(part.nodes.row(n).transpose(), image).transpose();
  }
  const bool turned = std::popcount(static_cast<unsigned>(image)) % 2 != 0;
  for (int t = 0; t < part.triangle_count(); ++t) {
    mirrored.normals[t] = image_of(part.normals[t], image);
    mirrored.centers[t] = image_of(part.centers[t], image);
    for (auto& curl : mirrored.curls[t]) curl = (turned ? -1 : 1) * image_of(Eigen::Vector3d(curl), image);
    if (!turned) continue;
    std::swap(mirrored.corners[t][1], mirrored.corners[t][2]);
    std::swap(mirrored.sides_of[t][1], mirrored.sides_of[t][2]);
    std::swap(mirrored.curls[t][1], mirrored.curls[t][2]);
  }
  for (Side& side : mirrored.sides) side.middle = image_of(side.middle, image);
  return mirrored;
}

}  // namespace ringdown::radiate
