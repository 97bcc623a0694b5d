#include "clients/viewer/render/drawn_mesh.h"

#include "engine/base/groups.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

// A bank's surface is turned into a mesh that can be shaded. First every point of the surface is split into one corner
// for each smooth patch of triangles around it; two neighbouring triangles belong to one patch when their normals
// differ by less than kCreaseAngle (creased). Then each flat triangle is replaced by a curved one (Curver), so that a
// coarse surface looks round. Normals are means over the triangles at a corner, weighted by angle.
namespace ringdown::viewer {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

glm::vec3 vector(const modal::Vec3f& v) { return {v[0], v[1], v[2]}; }

glm::vec3 doubled_area(const std::vector<glm::vec3>& at, const Triangle& t) {
  return glm::cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]]);
}

glm::vec3 unit(glm::vec3 v) {
  const float length = glm::length(v);
  return length > 0 ? v / length : glm::vec3(0, 0, 1);
}

void add_normals_and_bounds(DrawnMesh& mesh) {
  mesh.normals.assign(mesh.positions.size(), glm::vec3(0));
  // Normals are weighted by the angle at the corner, so that the way a flat part is cut into triangles does not matter.
  for (const Triangle& t : mesh.triangles) {
    const glm::vec3 normal = unit(doubled_area(mesh.positions, t));
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3 at = mesh.positions[t[k]];
      const glm::vec3 one = unit(mesh.positions[t[(k + 1) % 3]] - at),
                      other = unit(mesh.positions[t[(k + 2) % 3]] - at);
      mesh.normals[t[k]] += std::acos(std::clamp(glm::dot(one, other), -1.0F, 1.0F)) * normal;
    }
  }
  for (glm::vec3& normal : mesh.normals) normal = unit(normal);
  if (mesh.positions.empty()) return;
  mesh.low_m = mesh.high_m = mesh.positions.front();
  for (const glm::vec3& p : mesh.positions) {
    mesh.low_m = glm::min(mesh.low_m, p);
    mesh.high_m = glm::max(mesh.high_m, p);
  }
}

// The triangles around one point, united into smooth patches: a union-find over the triangles.
class Patches {
 public:
  Patches(const std::vector<Triangle>& triangles, const std::vector<glm::vec3>& normals,
          const std::vector<std::uint32_t>& around, std::uint32_t point)
      : parent_(around.size()) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    const float min = std::cos(kCreaseAngle);
    for (std::size_t i = 0; i < around.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (root(i) != root(j) && glm::dot(normals[around[i]], normals[around[j]]) > min &&
            share_edge(triangles[around[i]], triangles[around[j]], point))
          parent_[root(i)] = root(j);
      }
    }
  }
  [[nodiscard]] std::size_t root(std::size_t i) const {
    while (parent_[i] != i) i = parent_[i];
    return i;
  }

 private:
  static bool share_edge(const Triangle& a, const Triangle& b, std::uint32_t point) {
    return std::any_of(a.begin(), a.end(), [&](std::uint32_t corner) {
      return corner != point && std::find(b.begin(), b.end(), corner) != b.end();
    });
  }
  std::vector<std::size_t> parent_;
};

DrawnMesh creased(const std::vector<glm::vec3>& at, const std::vector<Triangle>& triangles) {
  std::vector<std::vector<std::uint32_t>> around(at.size());
  std::vector<glm::vec3> normals(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    normals[t] = unit(doubled_area(at, triangles[t]));
    for (const std::uint32_t point : triangles[t]) around[point].push_back(t);
  }
  DrawnMesh mesh;
  mesh.triangles = triangles;
  for (std::uint32_t point = 0; point < at.size(); ++point) {
    const Patches patches(triangles, normals, around[point], point);
    std::vector<std::uint32_t> corner_of(around[point].size());
    for (std::size_t i = 0; i < around[point].size(); ++i) {
      if (patches.root(i) != i) continue;
      corner_of[i] = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back(at[point]);
      mesh.origins.push_back({{point, point, point}});
    }
    for (std::size_t i = 0; i < around[point].size(); ++i) {
      const Triangle& before = triangles[around[point][i]];
      for (std::size_t side = 0; side < 3; ++side) {
        if (before[side] == point) mesh.triangles[around[point][i]][side] = corner_of[patches.root(i)];
      }
    }
  }
  add_normals_and_bounds(mesh);
  return mesh;
}

using Pair = std::pair<std::uint32_t, std::uint32_t>;

// Replaces each flat triangle by a curved PN triangle (Vlachos, Peters, Boyd, Mitchell: "Curved PN Triangles", 2001),
// cut into pieces^2 small flat ones.
//
// A PN triangle is a cubic Bezier patch whose corners are the triangle's own. Each edge has two control points, a third
// of the way from either end; a control point is the flat one projected into the plane of the corner's normal. The
// middle control point follows from the six of the edges. If an edge separates two smooth surfaces, both sides must
// compute equal control points or a gap opens: there the control point lies on the line in which the two tangent planes
// meet. If that line is not well defined, or at an open border, the edge stays straight.
//
// The corners of the flat mesh keep their numbers; corners within edges are shared by both triangles of one surface.
class Curver {
 public:
  Curver(const DrawnMesh& flat, std::uint32_t pieces) : flat_(flat), pieces_(pieces), made_(flat) {
    made_.triangles.clear();
    for (const auto& t : flat.triangles) {
      for (std::size_t k = 0; k < 3; ++k) corners_of_[{point(t[k]), point(t[(k + 1) % 3])}] = {t[k], t[(k + 1) % 3]};
    }
  }

  DrawnMesh run() && {
    for (const auto& t : flat_.triangles) cut(t);
    for (const glm::vec3& p : made_.positions)
      made_.low_m = glm::min(made_.low_m, p), made_.high_m = glm::max(made_.high_m, p);
    return std::move(made_);
  }

 private:
  [[nodiscard]] std::uint32_t point(std::uint32_t corner) const { return flat_.origins[corner].points[0]; }

  // The two control points of a triangle's edge, each about a third of the way from its end.
  [[nodiscard]] std::pair<glm::vec3, glm::vec3> controls(std::uint32_t first, std::uint32_t second) const {
    const auto across = corners_of_.find({point(second), point(first)});
    const bool open = across == corners_of_.end();
    const Pair other = open ? Pair{second, first} : across->second;
    return {control(first, second, other.second, other.first, open),
            control(second, first, other.first, other.second, open)};
  }

  // Returns the control point next to corner `from` of the edge to corner `to`. `other_from` and `other_to` are the
  // corners of the triangle beyond the edge at those two points; an edge without a triangle beyond is `open`.
  [[nodiscard]] glm::vec3 control(std::uint32_t from, std::uint32_t to, std::uint32_t other_from,
                                  std::uint32_t other_to, bool open) const {
    const glm::vec3 p = flat_.positions[from], way = flat_.positions[to] - p, n = flat_.normals[from];
    if (open) return p + way / 3.0F;
    if (other_from == from && other_to == to) return p + (way - glm::dot(way, n) * n) / 3.0F;
    const glm::vec3 edge = glm::cross(n, flat_.normals[other_from]);
    if (glm::dot(edge, edge) < 0.06F) return p + way / 3.0F;
    return p + glm::dot(way, edge) / glm::dot(edge, edge) * edge / 3.0F;
  }

  void cut(const std::array<std::uint32_t, 3>& t) {
    const glm::vec3 a = flat_.positions[t[0]], b = flat_.positions[t[1]], c = flat_.positions[t[2]];
    const auto [ab, ba] = controls(t[0], t[1]);
    const auto [bc, cb] = controls(t[1], t[2]);
    const auto [ca, ac] = controls(t[2], t[0]);
    const glm::vec3 edges = (ab + ba + bc + cb + ca + ac) / 6.0F;
    const glm::vec3 middle = edges + (edges - (a + b + c) / 3.0F) / 2.0F;
    std::vector<std::uint32_t> numbers;  // row by row from a: row r has r + 1 of them
    for (std::uint32_t row = 0; row <= pieces_; ++row) {
      for (std::uint32_t k = 0; k <= row; ++k) {
        const glm::vec3 w = glm::vec3(pieces_ - row, row - k, k) / static_cast<float>(pieces_);
        const float u = w.x, v = w.y, s = w.z;
        const glm::vec3 at = u * u * u * a + v * v * v * b + s * s * s * c +
                             3.0F * (u * u * v * ab + u * v * v * ba + v * v * s * bc + v * s * s * cb +
                                     s * s * u * ca + s * u * u * ac) +
                             6.0F * u * v * s * middle;
        numbers.push_back(corner(t, {pieces_ - row, row - k, k}, w, at));
      }
    }
    for (std::uint32_t row = 0, first = 0; row < pieces_; first += ++row) {
      const std::uint32_t below = first + row + 1;
      for (std::uint32_t k = 0; k <= row; ++k) {
        made_.triangles.push_back({numbers[first + k], numbers[below + k], numbers[below + k + 1]});
        if (k < row) made_.triangles.push_back({numbers[first + k], numbers[below + k + 1], numbers[first + k + 1]});
      }
    }
  }

  // Returns the number of a piece's corner, making the corner if it is new. Corners on an edge are shared with the
  // triangle beyond if both belong to one smooth surface.
  std::uint32_t corner(const std::array<std::uint32_t, 3>& t, std::array<std::uint32_t, 3> steps, glm::vec3 weights,
                       glm::vec3 at) {
    const auto zeros = std::count(steps.begin(), steps.end(), 0U);
    for (std::size_t k = 0; zeros == 2 && k < 3; ++k) {
      if (steps[k] != 0) return t[k];
    }
    const auto next = static_cast<std::uint32_t>(made_.positions.size());
    if (zeros == 1) {
      const std::size_t none = static_cast<std::size_t>(std::find(steps.begin(), steps.end(), 0U) - steps.begin());
      std::uint32_t from = t[(none + 1) % 3], to = t[(none + 2) % 3], step = steps[(none + 2) % 3];
      if (from > to) std::swap(from, to), step = pieces_ - step;
      const auto [found, is_new] = on_edges_.try_emplace({{from, to}, step}, next);
      if (!is_new) return found->second;
    }
    const glm::vec3 normal =
        weights.x * flat_.normals[t[0]] + weights.y * flat_.normals[t[1]] + weights.z * flat_.normals[t[2]];
    made_.positions.push_back(at);
    made_.normals.push_back(glm::normalize(normal));
    made_.origins.push_back({{point(t[0]), point(t[1]), point(t[2])}, {weights.x, weights.y, weights.z}});
    return next;
  }

  const DrawnMesh& flat_;
  std::uint32_t pieces_;
  DrawnMesh made_;
  std::map<Pair, Pair> corners_of_;  // directed edge between two points -> the two corners of its triangle
  std::map<std::pair<Pair, std::uint32_t>, std::uint32_t> on_edges_;
};

// The mesh in curved pieces: as many a triangle as kMaxPieces allows, at most 16.
DrawnMesh curved(const DrawnMesh& flat) {
  std::uint32_t pieces = 4;
  while (pieces > 1 && flat.triangles.size() * pieces * pieces > kMaxPieces) --pieces;
  return pieces == 1 ? flat : Curver(flat, pieces).run();
}

// Draws a bank without triangles: an octahedron at every step-th point.
DrawnMesh marks(const std::vector<glm::vec3>& at) {
  glm::vec3 low(at.front()), high(at.front());
  for (const glm::vec3& p : at) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const float radius = std::max(0.012F * glm::distance(low, high), 1e-4F);
  const std::size_t step = (at.size() + kMaxMarks - 1) / kMaxMarks;
  DrawnMesh mesh;
  for (std::size_t point = 0; point < at.size(); point += step) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int axis = 0; axis < 3; ++axis) {
      for (const float side : {radius, -radius}) {
        glm::vec3 corner = at[point];
        corner[axis] += side;
        mesh.positions.push_back(corner);
        const auto number = static_cast<std::uint32_t>(point);
        mesh.origins.push_back({{number, number, number}});
      }
    }
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      const std::uint32_t x = octant & 1, y = octant >> 1 & 1, z = octant >> 2;
      Triangle t = {first + x, first + 2 + y, first + 4 + z};
      if ((x + y + z) % 2 == 1) std::swap(t[1], t[2]);
      mesh.triangles.push_back(t);
    }
  }
  add_normals_and_bounds(mesh);
  return mesh;
}

void number_corners(DrawnMesh& mesh) {
  mesh.origins.clear();
  for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) mesh.origins.push_back({{i, i, i}});
}

}  // namespace

DrawnMesh shaded_mesh(const modal::Bank& bank) {
  std::vector<glm::vec3> at(bank.positions.size());
  std::transform(bank.positions.begin(), bank.positions.end(), at.begin(), vector);
  if (at.empty()) return {};
  return bank.triangles.empty() ? marks(at) : curved(creased(at, bank.triangles));
}

DrawnMesh box_mesh(glm::vec3 size_m) {
  std::vector<glm::vec3> at;
  for (std::uint32_t corner = 0; corner < 8; ++corner)
    at.push_back(size_m * (glm::vec3(corner & 1, corner >> 1 & 1, corner >> 2) - 0.5F));
  DrawnMesh mesh = creased(at, {{{0, 2, 1}},
                                {{1, 2, 3}},
                                {{4, 5, 6}},
                                {{5, 7, 6}},
                                {{0, 1, 4}},
                                {{1, 5, 4}},
                                {{2, 6, 3}},
                                {{3, 6, 7}},
                                {{0, 4, 2}},
                                {{2, 4, 6}},
                                {{1, 3, 5}},
                                {{3, 7, 5}}});
  number_corners(mesh);
  return mesh;
}

DrawnMesh sphere_mesh(float radius_m) {
  constexpr std::uint32_t kRings = 24, kSides = 48;
  DrawnMesh mesh;
  for (std::uint32_t ring = 0; ring <= kRings; ++ring) {
    const float polar = glm::pi<float>() * static_cast<float>(ring) / kRings;
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const float around = 2 * glm::pi<float>() * static_cast<float>(side) / kSides;
      mesh.normals.emplace_back(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around),
                                std::cos(polar));
      mesh.positions.push_back(radius_m * mesh.normals.back());
      if (ring == kRings) continue;
      const std::uint32_t a = ring * kSides + side, b = ring * kSides + (side + 1) % kSides;
      mesh.triangles.push_back({a, a + kSides, b});
      mesh.triangles.push_back({b, a + kSides, b + kSides});
    }
  }
  mesh.low_m = glm::vec3(-radius_m);
  mesh.high_m = glm::vec3(radius_m);
  number_corners(mesh);
  return mesh;
}

Displacement mode_displacement(const modal::Bank& bank, std::size_t mode) {
  assert(mode < bank.mode_count());
  std::vector<std::size_t> order(bank.mode_count());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&bank](auto a, auto b) { return bank.frequency_hz[a] < bank.frequency_hz[b]; });
  std::vector<glm::vec3> moves(bank.point_count());
  float largest = 0;
  for (std::size_t point = 0; point < moves.size(); ++point) {
    moves[point] = vector(bank.shape(order[mode], point));
    largest = std::max(largest, glm::length(moves[point]));
  }
  if (largest > 0) {
    for (glm::vec3& move : moves) move /= largest;
  }
  return std::make_shared<const std::vector<glm::vec3>>(std::move(moves));
}

std::vector<glm::vec3> corner_moves(const DrawnMesh& mesh, const std::vector<glm::vec3>& displacement) {
  std::vector<glm::vec3> moves(mesh.positions.size(), glm::vec3(0));
  for (std::size_t i = 0; i < moves.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t point = mesh.origins[i].points[k];
      if (point < displacement.size()) moves[i] += mesh.origins[i].weights[k] * displacement[point];
    }
  }
  return moves;
}

std::vector<glm::vec3> normal_changes(const DrawnMesh& mesh, const std::vector<glm::vec3>& moves) {
  std::vector<glm::vec3> sums(mesh.positions.size(), glm::vec3(0)), changes = sums;
  for (const auto& t : mesh.triangles) {
    const glm::vec3 ab = mesh.positions[t[1]] - mesh.positions[t[0]], ac = mesh.positions[t[2]] - mesh.positions[t[0]];
    const glm::vec3 ab_moves = moves[t[1]] - moves[t[0]], ac_moves = moves[t[2]] - moves[t[0]];
    const glm::vec3 change = glm::cross(ab_moves, ac) + glm::cross(ab, ac_moves);
    for (const std::uint32_t corner : t) {
      sums[corner] += glm::cross(ab, ac);
      changes[corner] += change;
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const float length = glm::length(sums[i]);
    changes[i] = length > 0 ? changes[i] / length : glm::vec3(0);
  }
  return changes;
}

}  // namespace ringdown::viewer
