#include "engine/shatter/cut.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <string>
#include <utility>

// The cut
//
// Every point has the set of cells that it belongs to: one for a point inside a cell, two or more on the border between
// cells. A tetrahedron is done when its four corners have a cell in common; it then belongs to that cell. All others
// are divided by points on their simplices, whose sets are the unions of the sets of the simplex's corners, so that the
// parts around the point need fewer cells than before:
//
//   1. Elements too coarse for the seeds are halved: those with an edge that passes through a cell neither end lies in,
//      and those around a seed whose cell has no point yet.
//   2. Where a plane meets an edge near one of its ends, that end becomes a point of the border.
//   3. A tetrahedron whose corners need four cells gets a point inside, a face whose corners need three gets a point,
//      and an edge whose ends have no cell in common is cut, each where the cells are equally near. A tetrahedron that
//      a plane passes through becomes tetrahedra and wedges, each wedge of three tetrahedra.
//   4. Steps 2 and 3 may leave a few simplices without a common cell although their edges have one, for instance a face
//      with {1, 2}, {2, 3} and {1, 3}. They all get a point, tetrahedra first, edges last; nothing can be left then,
//      because every chain of a simplex, a face of it, an edge of that and a corner has the corner's cells.
//   5. A flat part of a curved element may be more curved than it is thick, so that the tetrahedron between its corners
//      has too little volume or is inside out. The least shares of the edges that its points divide are then raised, up
//      to a half, where edges are not divided at all; if that is not enough, the element is halved. Parts that are thin
//      because the body's elements are get higher shares, too. Then steps 2 to 4 are done again.
//
// All decisions depend on the simplex alone and not on the tetrahedron it is seen from, so no gaps can open, whatever
// the rounding.
namespace ringdown::shatter {
namespace {

using Cells = std::vector<std::int32_t>;  // ascending

constexpr double kHidden = 0.35;  // a shorter passage through a cell, over the distance of the seeds, is left out
constexpr int kHalvings = 60;     // of step 1: the longest edge falls by half in about three
constexpr int kTrials = 20;       // of steps 2 to 5

Cells united(const Cells& a, const Cells& b) {
  Cells all;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all));
  return all;
}

class Cutter {
 public:
  Cutter(const mesh::TetMesh& body, const mesh::Points& seeds, const Eigen::RowVector3d& center)
      : body_(body), refinement_(body), seeds_(seeds.rowwise() - center), center_(center.transpose()) {
    add_points();
  }

  // Step 1.
  void refine() {
    for (int round = 0; round < kHalvings && divide_coarse(); ++round) {
    }
  }

  // Steps 2 to 5. Returns false if parts are left that are too flat for their curvature.
  bool cut() {
    for (int trial = 0; trial < kTrials; ++trial) {
      const Refinement base = refinement_;
      const std::vector<Cells> base_cells = cells_;
      refinement_ = Refinement::of_elements(base);
      origins_.assign(cells_.size(), Simplex{});
      snap();
      insert_borders();
      base_of_part_.clear();
      result_ = {{}, refinement_.elements(), {}};
      for (SubElement& part : result_.elements) {
        const SubElement& whole = base.elements()[static_cast<std::size_t>(part.parent)];
        base_of_part_.push_back(part.parent);
        part.parent = whole.parent;
        part.barycentric = (part.barycentric * whole.barycentric).eval();
      }
      place_points();
      std::vector<Simplex> halved;
      if (!raise_shares(base, halved)) return true;
      refinement_ = base;
      cells_ = base_cells;
      halve(halved);
    }
    return false;
  }

  // The cut body, after cut() has returned true.
  CutBody finish() {
    for (const SubElement& part : result_.elements) {
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      for (const std::int32_t corner : part.corners) middle += 0.25 * at(corner);
      const Cells possible = common(simplex_of(part, 15), 4);
      result_.cell.push_back(*std::min_element(possible.begin(), possible.end(), [&](std::int32_t a, std::int32_t b) {
        return farness(a, middle) < farness(b, middle);
      }));
    }
    return std::move(result_);
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

  // Returns the place on an edge at which two seeds are equally near: 0 is its first end and 1 its second. Other
  // numbers lie beyond the ends.
  [[nodiscard]] double crossing(const Simplex& edge, std::int32_t first, std::int32_t second) const {
    const double at_begin = farness(first, at(edge[0])) - farness(second, at(edge[0]));
    const double at_end = farness(first, at(edge[1])) - farness(second, at(edge[1]));
    return at_begin == at_end ? 0.5 : at_begin / (at_begin - at_end);
  }

  // Sets of cells

  [[nodiscard]] bool has(std::int32_t point, std::int32_t cell) const {
    return std::binary_search(cells_[point].begin(), cells_[point].end(), cell);
  }

  [[nodiscard]] Cells common(const Simplex& simplex, int count) const {
    Cells cells = cells_[simplex[0]];
    for (int c = 1; c < count; ++c) {
      std::erase_if(cells, [&](std::int32_t cell) { return !has(simplex[c], cell); });
    }
    return cells;
  }

  [[nodiscard]] bool has_common(const Simplex& simplex, int count) const {
    const Cells& cells = cells_[simplex[0]];
    return std::any_of(cells.begin(), cells.end(), [&](std::int32_t cell) {
      return std::all_of(simplex.begin() + 1, simplex.begin() + count, [&](std::int32_t c) { return has(c, cell); });
    });
  }

  [[nodiscard]] bool is_apart(const Simplex& edge) const { return !has_common(edge, 2); }

  // The least number of cells such that each corner belongs to one of them. The first `number` of `taken` are chosen
  // already, and corners before `from` belong to one of those.
  [[nodiscard]] int min_cells(const Simplex& simplex, int count, int from = 0, std::array<std::int32_t, 4> taken = {},
                              int number = 0) const {
    const auto is_covered = [&](std::int32_t point) {
      return std::any_of(taken.begin(), taken.begin() + number, [&](std::int32_t cell) { return has(point, cell); });
    };
    while (from < count && is_covered(simplex[from])) ++from;
    if (from == count) return number;
    int min = count;
    for (const std::int32_t cell : cells_[simplex[from]]) {
      taken[number] = cell;
      min = std::min(min, min_cells(simplex, count, from + 1, taken, number + 1));
    }
    return min;
  }

  void add_points() {
    while (std::ssize(cells_) < refinement_.point_count()) {
      cells_.push_back({nearest(at(static_cast<std::int32_t>(cells_.size())))});
    }
  }

  // Step 1: dividing coarse elements. Halving the longest edges keeps angles from degenerating (Rivara, Int. J. Num.
  // Meth. Eng. 20, 1984).

  void halve(const std::vector<Simplex>& edges) {
    std::vector<Insertion> insertions;
    insertions.reserve(edges.size());
    for (const Simplex& edge : edges) insertions.push_back({edge, {0.5, 0.5, 0, 0}});
    if (!insertions.empty()) refinement_.insert(insertions, 2);
    add_points();
  }

  bool divide_coarse() {
    std::vector<Eigen::Vector3d> lost;  // seeds without a point
    std::vector<bool> is_found(static_cast<std::size_t>(seeds_.rows()), false);
    for (const Cells& cells : cells_) is_found[static_cast<std::size_t>(cells[0])] = true;
    for (Eigen::Index seed = 0; seed < seeds_.rows(); ++seed) {
      if (!is_found[static_cast<std::size_t>(seed)]) lost.emplace_back(seeds_.row(seed).transpose());
    }
    const std::vector<Simplex> crossed =
        refinement_.find(2, [&](const Simplex& s) { return is_apart(s) && has_hidden_cell(s); });
    std::vector<Simplex> edges;
    const std::vector<int> pairs = corner_subsets(2);
    for (const SubElement& element : refinement_.elements()) {
      const bool is_coarse =
          std::any_of(lost.begin(), lost.end(), [&](const auto& seed) { return holds(element, seed); }) ||
          std::any_of(pairs.begin(), pairs.end(), [&](int pair) {
            return std::binary_search(crossed.begin(), crossed.end(), simplex_of(element, pair));
          });
      if (is_coarse) edges.push_back(longest_edge(refinement_, element));
    }
    edges = unique(std::move(edges));
    halve(edges);
    return !edges.empty();
  }

  // Returns true if an edge between two cells passes through a third one far enough to matter.
  [[nodiscard]] bool has_hidden_cell(const Simplex& edge) const {
    const std::int32_t first = cells_[edge[0]][0], second = cells_[edge[1]][0];
    const double share = crossing(edge, first, second);
    const std::int32_t between = nearest((1 - share) * at(edge[0]) + share * at(edge[1]));
    if (between == first || between == second) return false;
    const double apart_m =
        std::min((seeds_.row(between) - seeds_.row(first)).norm(), (seeds_.row(between) - seeds_.row(second)).norm());
    const double passage = crossing(edge, between, second) - crossing(edge, first, between);
    return passage > 2 * kMinShare && passage * (at(edge[0]) - at(edge[1])).norm() > kHidden * apart_m;
  }

  [[nodiscard]] bool holds(const SubElement& element, const Eigen::Vector3d& x) const {
    Eigen::Matrix3d edges;
    const Eigen::Vector3d from = at(element.corners[0]);
    for (int c = 0; c < 3; ++c) edges.col(c) = at(element.corners[c + 1]) - from;
    const Eigen::Vector3d shares = edges.inverse() * (x - from);
    constexpr double kRounding = 1e-9;
    return shares.minCoeff() >= -kRounding && shares.sum() <= 1 + kRounding;
  }

  static Simplex longest_edge(const Refinement& refinement, const SubElement& element) {
    Simplex longest{};
    double squared = -1;
    for (const int pair : corner_subsets(2)) {
      const Simplex edge = simplex_of(element, pair);
      const double own = (refinement.point(edge[0]) - refinement.point(edge[1])).squaredNorm();
      if (own > squared) {
        squared = own;
        longest = edge;
      }
    }
    return longest;
  }

  // Steps 2 to 4: borders.

  [[nodiscard]] double min_share(const Simplex& edge) const {
    const auto found = min_shares_.find(edge);
    return found == min_shares_.end() ? kMinShare : found->second;
  }

  void snap() {
    std::vector<std::pair<std::int32_t, std::int32_t>> added;  // point, cell
    for (const Simplex& edge : refinement_.find(2, [&](const Simplex& s) { return is_apart(s); })) {
      const std::int32_t first = cells_[edge[0]][0], second = cells_[edge[1]][0];
      const double share = crossing(edge, first, second), min = min_share(edge);
      if (share < min) added.emplace_back(edge[0], second);
      if (share >= 1 - min) added.emplace_back(edge[1], first);
    }
    for (const auto& [point, cell] : added) cells_[point] = united(cells_[point], {cell});
  }

  void insert_borders() {
    insert(4, [&](const Simplex& s) { return min_cells(s, 4) > 3; });
    insert(3, [&](const Simplex& s) { return min_cells(s, 3) > 2; });
    insert(2, [&](const Simplex& s) { return is_apart(s); });
    for (int count = 4; count > 1; --count) {
      insert(
          count, [&](const Simplex& s) { return !has_common(s, count); }, true);
    }
  }

  template <class Wanted>
  void insert(int count, const Wanted& wanted, bool in_middle = false) {
    std::vector<Insertion> insertions;
    for (const Simplex& simplex : refinement_.find(count, wanted)) {
      std::array<double, 4> weights{};
      std::fill_n(weights.begin(), count, 1.0 / count);
      if (!in_middle) weights = count == 2 ? cut_of(simplex) : meeting_point(simplex, count);
      insertions.push_back({simplex, weights});
      Cells all;
      for (int c = 0; c < count; ++c) all = united(all, cells_[simplex[c]]);
      cells_.push_back(std::move(all));
      origins_.push_back(simplex);
    }
    if (!insertions.empty()) refinement_.insert(insertions, count);
  }

  // Returns the point of a simplex at which the first cells of its corners are equally near, kept off its sides.
  [[nodiscard]] std::array<double, 4> meeting_point(const Simplex& simplex, int count) const {
    Eigen::Matrix4d equations = Eigen::Matrix4d::Identity();
    for (int c = 0; c < count; ++c) {
      equations(0, c) = 1;
      for (int row = 1; row < count; ++row) {
        equations(row, c) =
            farness(cells_[simplex[row]][0], at(simplex[c])) - farness(cells_[simplex[0]][0], at(simplex[c]));
      }
    }
    Eigen::Vector4d weights = equations.partialPivLu().solve(Eigen::Vector4d::UnitX());
    if (!weights.allFinite()) weights.setConstant(1);
    double sum = 0;
    for (int c = 0; c < count; ++c) sum += weights[c] = std::clamp(weights[c], kMinShare, 1.0);
    std::array<double, 4> shares{};
    for (int c = 0; c < count; ++c) shares[c] = weights[c] / sum;
    return shares;
  }

  // Returns the point at which an edge is cut. If an end lies on a border, the cell that is nearest to the edge's
  // middle counts.
  [[nodiscard]] std::array<double, 4> cut_of(const Simplex& edge) const {
    const Eigen::Vector3d middle = 0.5 * (at(edge[0]) + at(edge[1]));
    const auto nearer = [&](std::int32_t a, std::int32_t b) { return farness(a, middle) < farness(b, middle); };
    const Cells &first = cells_[edge[0]], &second = cells_[edge[1]];
    const double share = crossing(edge, *std::min_element(first.begin(), first.end(), nearer),
                                  *std::min_element(second.begin(), second.end(), nearer));
    const double min = min_share(edge), kept = std::clamp(share, min, 1 - min);
    return {1 - kept, kept, 0, 0};
  }

  // Step 5: flat parts of curved elements.

  // Moves the points to where the body's curved elements have them.
  void place_points() {
    result_.points.resize(refinement_.point_count(), 3);
    std::vector<bool> is_placed(static_cast<std::size_t>(refinement_.point_count()), false);
    for (const SubElement& part : result_.elements) {
      for (int c = 0; c < 4; ++c) {
        const auto corner = static_cast<std::size_t>(part.corners[c]);
        if (is_placed[corner]) continue;
        is_placed[corner] = true;
        const Eigen::VectorXd shares = mesh::interpolation(body_.order(), part.barycentric.row(c).transpose());
        result_.points.row(part.corners[c]) = shares.transpose() * mesh::nodes_of(body_, part.parent);
      }
    }
  }

  enum class Flatness { kNone, kThin, kFolded };

  // A part is folded if its corners span a tenth or less, or ten times, of what they would in a straight element, or so
  // little that mesh::check_mesh() takes it for no volume, with a margin of two. It is thin if they span a hundred
  // times that.
  [[nodiscard]] Flatness flatness_of(const SubElement& part) const {
    constexpr double kMinRatio = 0.1, kMaxRatio = 10, kNoVolume = 2e-9, kThinVolume = 1e-7;
    mesh::Corners corners;
    for (int c = 0; c < 4; ++c) corners.row(c) = result_.points.row(part.corners[c]);
    const double spanned = mesh::jacobian(corners).determinant();
    const double whole = mesh::jacobian(mesh::corners_of(body_, part.parent)).determinant();
    const double ratio = spanned / (part.barycentric.determinant() * whole);
    double longest = 0;
    for (const auto& [a, b] : mesh::kTetEdges) longest = std::max(longest, (corners.row(a) - corners.row(b)).norm());
    const double share = spanned / (longest * longest * longest);
    const bool is_bent = body_.order() > 1 && !(ratio > kMinRatio && ratio < kMaxRatio);
    if (is_bent || !(share > kNoVolume)) return Flatness::kFolded;
    return share < kThinVolume ? Flatness::kThin : Flatness::kNone;
  }

  // Raises the least shares of the edges that flat parts divide, and lists the edges to be halved where that is no help
  // against folding. Thin elements are left whole in the end, and nothing else can be done about them. Returns false if
  // there is nothing to do.
  bool raise_shares(const Refinement& base, std::vector<Simplex>& halved) {
    constexpr double kStep = 0.1;
    std::map<Simplex, double> raised;
    for (std::size_t k = 0; k < result_.elements.size(); ++k) {
      const Flatness flatness = flatness_of(result_.elements[k]);
      if (flatness == Flatness::kNone) continue;
      bool is_raised = false;
      for (const std::int32_t corner : result_.elements[k].corners) {
        const Simplex& origin = origins_[static_cast<std::size_t>(corner)];
        for (std::size_t a = 0; a < 4 && origin[1] > 0 && origin[a] >= 0; ++a) {
          for (std::size_t b = a + 1; b < 4 && origin[b] >= 0; ++b) {
            const Simplex edge = {origin[a], origin[b], -1, -1};
            if (origin[b] >= base.point_count() || min_share(edge) >= 0.5) continue;
            raised[edge] = std::min(0.5, min_share(edge) + kStep);
            is_raised = true;
          }
        }
      }
      if (is_raised || flatness == Flatness::kThin) continue;
      halved.push_back(longest_edge(base, base.elements()[static_cast<std::size_t>(base_of_part_[k])]));
    }
    for (const auto& [edge, share] : raised) min_shares_[edge] = share;
    halved = unique(std::move(halved));
    return !raised.empty() || !halved.empty();
  }

  const mesh::TetMesh& body_;
  Refinement refinement_;
  mesh::Points seeds_;  // from the center
  Eigen::Vector3d center_;
  std::vector<Cells> cells_;  // of each point

  // These two belong to one trial:
  std::vector<Simplex> origins_;            // of each point, the simplex it was inserted into; all 0: none
  std::vector<std::int32_t> base_of_part_;  // the element after step 1 that the part lies in
  CutBody result_;
  std::map<Simplex, double> min_shares_;  // of edges, where raised; kept from trial to trial
};

Result<void> check(const mesh::Points& seeds, double diagonal_m) {
  if (seeds.rows() == 0 || seeds.rows() > kMaxSeeds) {
    return fail(ErrorKind::bad_input, "a body is cut by 1 to {} seeds, not {}", kMaxSeeds, seeds.rows());
  }
  if (!seeds.allFinite()) return fail(ErrorKind::bad_input, "a coordinate of a seed is not a finite number");
  constexpr double kApart = 1e-6;
  for (Eigen::Index a = 0; a < seeds.rows(); ++a) {
    for (Eigen::Index b = a + 1; b < seeds.rows(); ++b) {
      if ((seeds.row(a) - seeds.row(b)).norm() > kApart * diagonal_m) continue;
      return fail(ErrorKind::bad_input, "seeds {} and {} lie in one place, so no plane divides them; remove one", a, b);
    }
  }
  return {};
}

}  // namespace

Result<CutBody> cut_body(const mesh::TetMesh& body, const mesh::Points& seeds) {
  const Eigen::RowVector3d low = body.nodes.colwise().minCoeff(), high = body.nodes.colwise().maxCoeff();
  if (auto sound = check(seeds, (high - low).norm()); !sound) return fail(sound);
  Cutter cutter(body, seeds, 0.5 * (low + high));
  cutter.refine();
  if (!cutter.cut()) {
    return fail(ErrorKind::refused,
                "elements are too flat or too curved to be cut without folding; give a finer mesh, or other seeds");
  }
  return cutter.finish();
}

}  // namespace ringdown::shatter
