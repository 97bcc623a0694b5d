#include "clients/viewer/render/liquid_surface.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace ringdown::viewer {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // of the surface, lower point first

// Where the level crosses an edge, and the edge that the line goes to from there, with the wall on its left as seen
// from above.
struct Crossing {
  Vec3 point_m;
  Edge next;
};

Vec3 at(const modal::Bank& bank, std::uint32_t point) {
  const modal::Vec3f& p = bank.positions[point];
  return {p[0], p[1], p[2]};
}

Vec3 up_of(const modal::Bank& bank) {
  for (const modal::LiquidNote& note : bank.provenance.liquids) {
    if (!note.around) return (1 / length(note.up)) * note.up;
  }
  return {0, 0, 1};
}

std::map<Edge, Crossing> crossings(const modal::Bank& bank, const Vec3& up, double level_m) {
  std::map<Edge, Crossing> found;
  // A point at the very level counts as below it.
  const auto above = [&](std::uint32_t point) { return dot(up, at(bank, point)) > level_m; };
  for (const auto& triangle : bank.triangles) {
    std::vector<std::pair<Edge, Vec3>> ends;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = std::min(triangle[k], triangle[(k + 1) % 3]);
      const std::uint32_t b = std::max(triangle[k], triangle[(k + 1) % 3]);
      if (above(a) == above(b)) continue;
      const Vec3 from = at(bank, a), to = at(bank, b);
      const double part = (level_m - dot(up, from)) / dot(up, to - from);
      ends.push_back({{a, b}, from + part * (to - from)});
    }
    if (ends.size() != 2) continue;
    const Vec3 corner = at(bank, triangle[0]);
    const Vec3 out = cross(at(bank, triangle[1]) - corner, at(bank, triangle[2]) - corner);
    if (dot(ends[1].second - ends[0].second, cross(up, out)) < 0) std::swap(ends[0], ends[1]);
    found.insert_or_assign(ends[0].first, Crossing{ends[0].second, ends[1].first});
  }
  return found;
}

glm::vec3 to_glm(const Vec3& v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

DrawnMesh fan(const std::vector<Vec3>& line, const Vec3& up) {
  Vec3 middle;
  for (const Vec3& point : line) middle = middle + (1.0 / static_cast<double>(line.size())) * point;
  DrawnMesh mesh;
  for (const Vec3& point : line) mesh.positions.push_back(to_glm(point));
  mesh.positions.push_back(to_glm(middle));
  mesh.low_m = mesh.high_m = mesh.positions[0];
  for (std::uint32_t k = 0; k < mesh.positions.size(); ++k) {
    mesh.normals.push_back(to_glm(up));
    mesh.origins.push_back({.points = {k, k, k}});
    mesh.low_m = glm::min(mesh.low_m, mesh.positions[k]);
    mesh.high_m = glm::max(mesh.high_m, mesh.positions[k]);
  }
  const auto count = static_cast<std::uint32_t>(line.size());
  for (std::uint32_t k = 0; k < count; ++k) mesh.triangles.push_back({count, (k + 1) % count, k});
  return mesh;
}

}  // namespace

std::optional<DrawnMesh> liquid_surface(const modal::Bank& bank, double level_m) {
  const Vec3 up = up_of(bank);
  std::map<Edge, Crossing> open = crossings(bank, up, level_m);
  std::vector<Vec3> widest;
  double least = 0;  // a line with the wall around it has a negative area
  while (!open.empty()) {
    std::vector<Vec3> line;
    for (auto here = open.begin(); here != open.end();) {
      const Edge next = here->second.next;
      line.push_back(here->second.point_m);
      open.erase(here);
      here = open.find(next);
    }
    double area = 0;
    for (std::size_t k = 0; k < line.size(); ++k)
      area += 0.5 * dot(up, cross(line[k] - line[0], line[(k + 1) % line.size()] - line[0]));
    if (area >= least) continue;
    least = area;
    widest = std::move(line);
  }
  if (widest.size() < 3) return std::nullopt;
  return fan(widest, up);
}

}  // namespace ringdown::viewer
