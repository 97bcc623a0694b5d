#include "engine/mesh/triangle_mesh.h"

#include "engine/base/output_file.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace ringdown::mesh {

double diagonal_of(const TriangleMesh& mesh) {
  if (mesh.triangles.rows() == 0) return 0;
  Eigen::RowVector3d low = Eigen::RowVector3d::Constant(HUGE_VAL), high = -low;
  for (const std::int32_t node : mesh.triangles.reshaped()) {
    low = low.cwiseMin(mesh.nodes.row(node));
    high = high.cwiseMax(mesh.nodes.row(node));
  }
  return (high - low).norm();
}

void drop_unused_nodes(TriangleMesh& mesh) {
  std::vector<std::int32_t> number(static_cast<std::size_t>(mesh.nodes.rows()), -1);
  std::int32_t kept = 0;
  for (const std::int32_t n : mesh.triangles.reshaped()) number[static_cast<std::size_t>(n)] = 0;
  for (std::size_t n = 0; n < number.size(); ++n) {
    if (number[n] < 0) continue;
    mesh.nodes.row(kept) = mesh.nodes.row(static_cast<Eigen::Index>(n)).eval();
    number[n] = kept++;
  }
  mesh.nodes.conservativeResize(kept, 3);
  for (std::int32_t& n : mesh.triangles.reshaped()) n = number[static_cast<std::size_t>(n)];
}

std::vector<EdgeUse> edges_of(const TriangleMesh& mesh, const std::vector<bool>& usable) {
  std::vector<EdgeUse> edges;
  edges.reserve(3 * usable.size());
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    if (!usable[static_cast<std::size_t>(t)]) continue;
    for (int i = 0; i < 3; ++i) {
      const std::int32_t from = mesh.triangles(t, i), to = mesh.triangles(t, (i + 1) % 3);
      edges.push_back({std::min(from, to), std::max(from, to), static_cast<std::int32_t>(t), from < to});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return edges;
}

TriangleFans::TriangleFans(const TriangleMesh& mesh) : first_(static_cast<std::size_t>(mesh.nodes.rows()) + 1, 0) {
  for (const std::int32_t n : mesh.triangles.reshaped()) ++first_[static_cast<std::size_t>(n) + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  triangles_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for (std::int32_t t = 0; t < mesh.triangles.rows(); ++t) {
    for (int i = 0; i < 3; ++i) triangles_[next[static_cast<std::size_t>(mesh.triangles(t, i))]++] = t;
  }
}

bool is_degenerate(const TriangleMesh& mesh, Eigen::Index triangle) {
  constexpr double kFlat = 1e-12;
  const auto corners = mesh.triangles.row(triangle);
  if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) return true;
  const Eigen::RowVector3d a = mesh.nodes.row(corners[0]), b = mesh.nodes.row(corners[1]),
                           c = mesh.nodes.row(corners[2]);
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return (b - a).cross(c - a).norm() <= kFlat * longest;
}

// Starts from each unused edge, follows edges, and records the nodes of the path. When the path returns to one of its
// nodes, the part since then is a loop; the loop is taken out, and the path continues from that node. Each edge is
// entered once, and each node leaves the path as often as it entered, so the cost is O(edges).
std::vector<std::vector<std::int32_t>> loops_of(const std::vector<EdgeUse>& edges, std::size_t* steps) {
  std::unordered_map<std::int32_t, std::vector<std::size_t>> unused;  // edges that start at a node
  const auto start = [&edges](std::size_t e) { return edges[e].forward ? edges[e].high : edges[e].low; };
  for (std::size_t e = 0; e < edges.size(); ++e) unused[start(e)].push_back(e);
  std::vector<bool> used(edges.size(), false);
  std::unordered_map<std::int32_t, std::size_t> position;  // position of each node in `way`
  std::vector<std::vector<std::int32_t>> loops;
  std::size_t visits = 0;
  for (std::size_t seed = 0; seed < edges.size(); ++seed) {
    if (used[seed]) continue;
    std::vector<std::int32_t> way = {start(seed)};
    position.emplace(way.front(), 0);
    for (std::size_t e = seed; !used[e];) {
      used[e] = true;
      const std::int32_t end = edges[e].low + edges[e].high - start(e);
      if (const auto before = position.find(end); before != position.end()) {
        const std::size_t first = before->second;
        const auto from = way.begin() + static_cast<std::ptrdiff_t>(first);
        if (way.size() - first > 2) loops.emplace_back(from, way.end());
        for (std::size_t i = first + 1; i < way.size(); ++i, ++visits) position.erase(way[i]);
        way.resize(first + 1);
      } else {
        position.emplace(end, way.size());
        way.push_back(end);
      }
      std::vector<std::size_t>& next = unused[way.back()];
      for (; !next.empty() && used[next.back()]; ++visits) next.pop_back();
      if (!next.empty()) e = next.back();
      ++visits;
    }
    for (const std::int32_t node : way) position.erase(node);
  }
  if (steps) *steps += visits + edges.size();
  return loops;
}

double spanned_area(const TriangleMesh& mesh, const std::vector<std::int32_t>& loop) {
  Eigen::RowVector3d area = Eigen::RowVector3d::Zero();
  const Eigen::RowVector3d first = mesh.nodes.row(loop.front());
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    const Eigen::RowVector3d a = mesh.nodes.row(loop[i]), b = mesh.nodes.row(loop[i + 1]);
    area += 0.5 * (a - first).cross(b - first);
  }
  return area.norm();
}

std::vector<bool> duplicates_in(const TriangleMesh& mesh) {
  const auto count = static_cast<std::size_t>(mesh.triangles.rows());
  std::vector<std::array<std::int32_t, 4>> keys(count);
  for (std::size_t t = 0; t < count; ++t) {
    const auto row = mesh.triangles.row(static_cast<Eigen::Index>(t));
    keys[t] = {row[0], row[1], row[2], static_cast<std::int32_t>(t)};
    std::sort(keys[t].begin(), keys[t].begin() + 3);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<bool> copies(count, false);
  for (std::size_t k = 1; k < count; ++k) {
    const bool same = std::equal(keys[k].begin(), keys[k].begin() + 3, keys[k - 1].begin());
    if (same && !is_degenerate(mesh, keys[k][3])) copies[static_cast<std::size_t>(keys[k][3])] = true;
  }
  return copies;
}

std::vector<bool> usable_triangles(const TriangleMesh& mesh) {
  std::vector<bool> usable = duplicates_in(mesh);
  usable.flip();
  for (std::size_t t = 0; t < usable.size(); ++t) {
    if (is_degenerate(mesh, static_cast<Eigen::Index>(t))) usable[t] = false;
  }
  return usable;
}

Result<void> write_ply(const TriangleMesh& surface, const std::filesystem::path& path) {
  std::string text = formatted(
      "ply\nformat ascii 1.0\ncomment lengths in metres\nelement vertex {}\nproperty double x\nproperty double y\n"
      "property double z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      surface.nodes.rows(), surface.triangles.rows());
  for (const auto& node : surface.nodes.rowwise()) {
    text += formatted("{:.9g} {:.9g} {:.9g}\n", node[0], node[1], node[2]);
  }
  for (const auto& row : surface.triangles.rowwise()) text += formatted("3 {} {} {}\n", row[0], row[1], row[2]);
  return write_output(path, text);
}

}  // namespace ringdown::mesh
