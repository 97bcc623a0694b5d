#include "engine/shatter/cut.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

// The cut
//
// Every point has the set of cells that it belongs to: one for a point inside a cell, two or more on the border between
// cells. A tetrahedron is done when its four corners have a cell in common; it then belongs to that cell. All others
// are divided by points on their simplices, whose sets are the unions of the sets of the simplex's corners, so that the
// parts around the point need fewer cells than before:
//
//   1. Elements too coarse for the seeds are divided: an edge that passes through a cell neither end lies in, and the
//      longest edge around a seed whose cell has no point yet.
//   2. Where a plane meets an edge near one of its ends, that end becomes a point of the border.
//   3. A tetrahedron whose corners need four cells gets a point inside, a face whose corners need three gets a point,
//      and an edge whose ends have no cell in common is cut, each where the cells are equally near. In a tetrahedron
//      that two planes or one pass through, this leaves the usual tetrahedra and wedges.
//   4. Steps 2 and 3 may leave a few simplices without a common cell although their edges have one, for instance a face
//      with {1, 2}, {2, 3} and {1, 3}. They all get a point, tetrahedra first, edges last; nothing can be left then,
//      because every chain of a simplex, a face of it, an edge of that and a corner has the corner's cells.
//
// All decisions depend on the simplex alone and not on the tetrahedron it is seen from, so no gaps can open, whatever
// the rounding.
namespace ringdown::shatter {
namespace {

using Cells = std::vector<std::int32_t>;  // ascending

class Cutter {
 public:
  Cutter(const mesh::TetMesh& body, const mesh::Points& seeds, const Eigen::RowVector3d& center)
      : refinement_(body), seeds_(seeds.rowwise() - center), center_(center.transpose()) {
    add_points();
  }

  void refine() {
    constexpr int kRounds = 60;
    for (int round = 0; round < kRounds; ++round) {
      if (!divide_at_hidden_cells() && !divide_around_lost_seeds()) break;
    }
  }

  void snap() {
    const auto edges = refinement_.find(2, [&](const Simplex& s) { return is_apart(s); });
    std::vector<std::pair<std::int32_t, std::int32_t>> added;
    for (const Simplex& edge : edges) {
      const std::int32_t first = cells_[edge[0]][0], second = cells_[edge[1]][0];
      const double at = crossing(edge, first, second);
      if (at < kLeastShare) added.emplace_back(edge[0], second);
      if (at > 1 - kLeastShare) added.emplace_back(edge[1], first);
    }
    for (const auto& [point, cell] : added) cells_[point] = united(cells_[point], {cell});
  }

  void cut() {
    insert(4, [&](const Simplex& s) { return least_cells(s, 4) > 3; });
    insert(3, [&](const Simplex& s) { return least_cells(s, 3) > 2; });
    insert(2, [&](const Simplex& s) { return is_apart(s); });
    for (int count = 4; count > 1; --count) {
      insert(count, [&](const Simplex& s) { return common(s, count).empty(); });
    }
  }

  CutBody finish(const mesh::TetMesh& body) {
    CutBody cut{mesh::Points(refinement_.point_count(), 3), refinement_.elements(), {}};
    std::vector<bool> placed(refinement_.point_count(), false);
    for (const SubElement& element : cut.elements) {
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      for (int c = 0; c < 4; ++c) {
        middle += 0.25 * at(element.corners[c]);
        if (placed[element.corners[c]]) continue;
        placed[element.corners[c]] = true;
        const Eigen::VectorXd shares = mesh::interpolation(body.order(), element.barycentric.row(c).transpose());
        cut.points.row(element.corners[c]) = shares.transpose() * mesh::nodes_of(body, element.parent);
      }
      const Cells possible = common(simplex_of(element, 15), 4);
      cut.cell.push_back(*std::min_element(possible.begin(), possible.end(), [&](std::int32_t a, std::int32_t b) {
        return farness(a, middle) < farness(b, middle);
      }));
    }
    return cut;
  }

 private:
  [[nodiscard]] Eigen::Vector3d at(std::int32_t point) const { return refinement_.point(point) - center_; }

  // The square of the distance to a seed, less |x|^2, which is equal for all seeds.
  [[nodiscard]] double farness(std::int32_t seed, const Eigen::Vector3d& x) const {
    return seeds_.row(seed).squaredNorm() - 2 * seeds_.row(seed).dot(x);
  }

  [[nodiscard]] std::int32_t nearest(const Eigen::Vector3d& x) const {
    std::int32_t best = 0;
    for (std::int32_t k = 1; k < seeds_.rows(); ++k) {
      if (farness(k, x) < farness(best, x)) best = k;
    }
    return best;
  }

  // Where on an edge two seeds are equally near: 0 at its first end, 1 at its second; beyond if not between them.
  [[nodiscard]] double crossing(const Simplex& edge, std::int32_t first, std::int32_t second) const {
    const double at_begin = farness(first, at(edge[0])) - farness(second, at(edge[0]));
    const double at_end = farness(first, at(edge[1])) - farness(second, at(edge[1]));
    return at_begin == at_end ? 0.5 : at_begin / (at_begin - at_end);
  }

  static Cells united(const Cells& a, const Cells& b) {
    Cells all;
    std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all));
    return all;
  }

  [[nodiscard]] Cells common(const Simplex& simplex, int count) const {
    Cells cells = cells_[simplex[0]];
    for (int c = 1; c < count; ++c) {
      std::erase_if(cells, [&](std::int32_t cell) { return !has(simplex[c], cell); });
    }
    return cells;
  }

  [[nodiscard]] bool has(std::int32_t point, std::int32_t cell) const {
    return std::find(cells_[point].begin(), cells_[point].end(), cell) != cells_[point].end();
  }
  [[nodiscard]] bool is_apart(const Simplex& edge) const { return common(edge, 2).empty(); }

  // The least number of cells such that each corner belongs to one of them.
  [[nodiscard]] int least_cells(const Simplex& simplex, int count, int from = 0, std::array<std::int32_t, 4> taken = {},
                                int number = 0) const {
    const auto is_covered = [&](std::int32_t point) {
      return std::any_of(taken.begin(), taken.begin() + number, [&](std::int32_t cell) { return has(point, cell); });
    };
    while (from < count && is_covered(simplex[from])) ++from;
    if (from == count) return number;
    int least = count;
    for (const std::int32_t cell : cells_[simplex[from]]) {
      taken[number] = cell;
      least = std::min(least, least_cells(simplex, count, from + 1, taken, number + 1));
    }
    return least;
  }

  // Where in a simplex the first cells of its corners are equally near, kept off its sides.
  [[nodiscard]] std::array<double, 4> meeting_point(const Simplex& simplex, int count) const {
    Eigen::Matrix4d equations = Eigen::Matrix4d::Identity();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    right[0] = 1;
    for (int c = 0; c < count; ++c) {
      equations(0, c) = 1;
      for (int row = 1; row < count; ++row) {
        equations(row, c) = farness(cells_[simplex[row]][0], at(simplex[c])) -
                            farness(cells_[simplex[0]][0], at(simplex[c]));
      }
    }
    Eigen::Vector4d weights = equations.partialPivLu().solve(right);
    if (!weights.allFinite()) weights.setConstant(1);
    double sum = 0;
    for (int c = 0; c < count; ++c) sum += weights[c] = std::clamp(weights[c], kLeastShare, 1.0);
    std::array<double, 4> shares{};
    for (int c = 0; c < count; ++c) shares[c] = weights[c] / sum;
    return shares;
  }

  // Where an edge is cut. If an end lies on a border, the last of its cells before the edge's middle counts.
  [[nodiscard]] std::array<double, 4> cut_of(const Simplex& edge) const {
    const Eigen::Vector3d middle = 0.5 * (at(edge[0]) + at(edge[1]));
    const auto nearer = [&](std::int32_t a, std::int32_t b) { return farness(a, middle) < farness(b, middle); };
    const Cells &first = cells_[edge[0]], &second = cells_[edge[1]];
    const double share = crossing(edge, *std::min_element(first.begin(), first.end(), nearer),
                                  *std::min_element(second.begin(), second.end(), nearer));
    const double kept = std::clamp(share, kLeastShare, 1 - kLeastShare);
    return {1 - kept, kept, 0, 0};
  }

  template <class Wanted>
  void insert(int count, const Wanted& wanted) {
    std::vector<Insertion> insertions;
    for (const Simplex& simplex : refinement_.find(count, wanted)) {
      insertions.push_back({simplex, count == 2 ? cut_of(simplex) : meeting_point(simplex, count)});
      Cells all;
      for (int c = 0; c < count; ++c) all = united(all, cells_[simplex[c]]);
      cells_.push_back(std::move(all));
    }
    if (!insertions.empty()) refinement_.insert(insertions, count);
  }

  void add_points() {
    while (std::ssize(cells_) < refinement_.point_count()) {
      cells_.push_back({nearest(at(static_cast<std::int32_t>(cells_.size())))});
    }
  }

  bool divide_at_hidden_cells() {
    std::vector<Insertion> insertions;
    for (const Simplex& edge : refinement_.find(2, [&](const Simplex& s) { return is_apart(s); })) {
      const std::int32_t first = cells_[edge[0]][0], second = cells_[edge[1]][0];
      const double share = crossing(edge, first, second);
      const std::int32_t between = nearest((1 - share) * at(edge[0]) + share * at(edge[1]));
      if (between == first || between == second) continue;
      const double begin = crossing(edge, first, between), end = crossing(edge, between, second);
      if (end - begin < 2 * kLeastShare) continue;
      const double middle = std::clamp(0.5 * (begin + end), kLeastShare, 1 - kLeastShare);
      insertions.push_back({edge, {1 - middle, middle, 0, 0}});
    }
    if (insertions.empty()) return false;
    refinement_.insert(insertions, 2);
    add_points();
    return true;
  }

  bool divide_around_lost_seeds() {
    std::vector<bool> found(seeds_.rows(), false);
    for (const Cells& cells : cells_) found[cells[0]] = true;
    std::vector<Simplex> edges;
    for (std::int32_t seed = 0; seed < seeds_.rows(); ++seed) {
      if (found[seed]) continue;
      for (const SubElement& element : refinement_.elements()) {
        if (holds(element, seeds_.row(seed).transpose())) edges.push_back(longest_edge(element));
      }
    }
    std::vector<Insertion> insertions;
    for (const Simplex& edge : unique(std::move(edges))) insertions.push_back({edge, {0.5, 0.5, 0, 0}});
    if (insertions.empty()) return false;
    refinement_.insert(insertions, 2);
    add_points();
    return true;
  }

  [[nodiscard]] bool holds(const SubElement& element, const Eigen::Vector3d& x) const {
    Eigen::Matrix3d edges;
    const Eigen::Vector3d from = at(element.corners[0]);
    for (int c = 0; c < 3; ++c) edges.col(c) = at(element.corners[c + 1]) - from;
    const Eigen::Vector3d shares = edges.inverse() * (x - from);
    constexpr double kRounding = 1e-9;
    return shares.minCoeff() >= -kRounding && shares.sum() <= 1 + kRounding;
  }

  [[nodiscard]] Simplex longest_edge(const SubElement& element) const {
    Simplex longest{};
    double squared = -1;
    for (const int subset : corner_subsets(2)) {
      const Simplex edge = simplex_of(element, subset);
      const double own = (at(edge[0]) - at(edge[1])).squaredNorm();
      if (own > squared) squared = own, longest = edge;
    }
    return longest;
  }

  Refinement refinement_;
  mesh::Points seeds_;  // from the center
  Eigen::Vector3d center_;
  std::vector<Cells> cells_;  // of each point
};

Result<void> check(const mesh::Points& seeds, double diagonal_m) {
  if (seeds.rows() == 0 || seeds.rows() > kMaxSeeds) {
    return fail(ErrorKind::bad_input, "a body is cut by 1 to " + std::to_string(kMaxSeeds) + " seeds, not " +
                                          std::to_string(seeds.rows()));
  }
  if (!seeds.allFinite()) return fail(ErrorKind::bad_input, "a coordinate of a seed is not a finite number");
  constexpr double kApart = 1e-6;
  for (Eigen::Index a = 0; a < seeds.rows(); ++a) {
    for (Eigen::Index b = a + 1; b < seeds.rows(); ++b) {
      if ((seeds.row(a) - seeds.row(b)).norm() > kApart * diagonal_m) continue;
      return fail(ErrorKind::bad_input, "seeds " + std::to_string(a) + " and " + std::to_string(b) +
                                            " lie in one place, so no plane divides them; remove one");
    }
  }
  return {};
}

}  // namespace

Result<CutBody> cut_body(const mesh::TetMesh& body, const mesh::Points& seeds) {
  const Eigen::RowVector3d low = body.nodes.colwise().minCoeff(), high = body.nodes.colwise().maxCoeff();
  if (auto sound = check(seeds, (high - low).norm()); !sound) return fail(sound.error());
  Cutter cutter(body, seeds, 0.5 * (low + high));
  cutter.refine();
  cutter.snap();
  cutter.cut();
  return cutter.finish(body);
}

}  // namespace ringdown::shatter
