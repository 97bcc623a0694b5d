#include "clients/viewer/render/curved_mesh.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <map>
#include <utility>

namespace ringdown::viewer {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

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

  // The two control points of a triangle's edge, each a third of the way from its end.
  [[nodiscard]] std::pair<glm::vec3, glm::vec3> controls(std::uint32_t first, std::uint32_t second) const {
    const auto across = corners_of_.find({point(second), point(first)});
    const bool open = across == corners_of_.end();
    const Pair other = open ? Pair{second, first} : across->second;
    return {control(first, second, other.second, other.first, open),
            control(second, first, other.first, other.second, open)};
  }

  // `other_from` and `other_to` are the corners there of the triangle beyond.
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

  // A corner of one of the pieces; those on the edges are shared with the triangle beyond when it is of the same
  // surface.
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
  std::map<Pair, Pair> corners_of_;  // of the directed edge from one point to another
  std::map<std::pair<Pair, std::uint32_t>, std::uint32_t> on_edges_;
};

}  // namespace

DrawnMesh curved(const DrawnMesh& flat) {
  std::uint32_t pieces = 4;
  while (pieces > 1 && flat.triangles.size() * pieces * pieces > kMaxPieces) --pieces;
  return pieces == 1 ? flat : Curver(flat, pieces).run();
}

}  // namespace ringdown::viewer
