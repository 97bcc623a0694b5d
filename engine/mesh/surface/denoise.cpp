#include "engine/mesh/surface/denoise.h"

#include "engine/dense/decompositions.h"
#include "engine/mesh/surface/surface_check.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

// Normals first, then nodes
//
// First, a plain average over each triangle's neighbourhood (all triangles that share a node with it) turns the normals
// of folded triangles; if the other triangles' normals are averaged, too, edges become rounder. kNormalRounds bilateral
// averages follow, in which a neighbour counts less the more its normal differs, so that the two sides of an edge do
// not mix. Then nodes move, kNodeRounds times: towards the planes that the new normals give their triangles, and along
// the surface (on an edge, along the edge) to the middle of their neighbours, which unfolds triangles. Last, all nodes
// move along their normals by one length that restores the body's volume.
namespace ringdown::mesh {
namespace {

using Eigen::RowVector3d;

constexpr int kNormalRounds = 10, kNodeRounds = 15;
constexpr double kAlike = 0.35;        // difference of unit normals that about halves a weight
constexpr double kFolded = 0.5;        // cosine from a normal to the mean around it, below which it counts as folded
constexpr double kFreeShare = 0.1;     // largest share of the normals' squares along a direction in all planes
constexpr double kAlong = 0.3;         // share of the way to the middle of the neighbours
constexpr double kRough_deg = 5;       // angle between the normals of most neighbours
constexpr double kFineTriangles = 40;  // number of sides along the diagonal
constexpr double kFolds = 0.8;         // share of neighbours among the pairs that cut each other

class Denoising {
 public:
  explicit Denoising(const TriangleMesh& surface) : from_(surface), fans_(surface), to_(surface) {
    const Eigen::Index count = to_.triangles.rows();
    normals_.resize(count, 3);
    areas_.resize(count);
    measure();
  }

  Denoised run(FirstAverage first) {
    average_normals(first);
    for (int round = 0; round < kNormalRounds; ++round) average_normals({});
    for (int round = 0; round < kNodeRounds; ++round) move_nodes();
    const double lost_m3 = volume(from_) - volume(to_);
    measure();
    const Normals outward = node_normals();
    to_.nodes += lost_m3 / areas_.sum() * outward;
    const double sum = (to_.nodes - from_.nodes).squaredNorm();
    return {std::move(to_), std::sqrt(sum / static_cast<double>(std::max<Eigen::Index>(1, from_.nodes.rows())))};
  }

  [[nodiscard]] bool is_rough() const {
    std::vector<double> turns;
    const std::vector<EdgeUse> edges =
        edges_of(from_, std::vector<bool>(static_cast<std::size_t>(from_.triangles.rows()), true));
    double length = 0;
    for (std::size_t first = 0, last; first < edges.size(); first = last) {
      last = end_of_edge(edges, first);
      if (last - first != 2) continue;
      const RowVector3d a = normals_.row(edges[first].triangle), b = normals_.row(edges[first + 1].triangle);
      turns.push_back(std::atan2(a.cross(b).norm(), a.dot(b)));
      length += (from_.nodes.row(edges[first].low) - from_.nodes.row(edges[first].high)).norm();
    }
    if (turns.empty() || length / static_cast<double>(turns.size()) > diagonal_of(from_) / kFineTriangles) return false;
    const auto middle = turns.begin() + static_cast<std::ptrdiff_t>(turns.size() / 2);
    std::nth_element(turns.begin(), middle, turns.end());
    return *middle > kRough_deg * std::numbers::pi / 180;
  }

  // Returns true if some triangle has a node of `a` and a node of `b`.
  [[nodiscard]] bool are_neighbours(std::int32_t a, std::int32_t b) const {
    for (const std::int32_t node : from_.triangles.row(a)) {
      for (const std::int32_t beside : fans_.at(node)) {
        for (const std::int32_t other : from_.triangles.row(beside)) {
          if ((from_.triangles.row(b).array() == other).any()) return true;
        }
      }
    }
    return false;
  }

 private:
  using Normals = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

  static double volume(const TriangleMesh& mesh) {
    double sum = 0;
    for (const auto& row : mesh.triangles.rowwise()) {
      const RowVector3d a = mesh.nodes.row(row[0]), b = mesh.nodes.row(row[1]), c = mesh.nodes.row(row[2]);
      sum += a.dot(b.cross(c)) / 6;
    }
    return sum;
  }

  void measure() {
    for (Eigen::Index t = 0; t < to_.triangles.rows(); ++t) {
      const auto row = to_.triangles.row(t);
      const RowVector3d a = to_.nodes.row(row[0]), b = to_.nodes.row(row[1]), c = to_.nodes.row(row[2]);
      const RowVector3d twice = (b - a).cross(c - a);
      areas_[t] = 0.5 * twice.norm();
      normals_.row(t) = areas_[t] > 0 ? RowVector3d(twice.normalized()) : RowVector3d(0, 0, 0);
    }
  }

  // Without `first` the average is bilateral.
  void average_normals(std::optional<FirstAverage> first) {
    Normals next(normals_.rows(), 3);
    for (Eigen::Index t = 0; t < normals_.rows(); ++t) {
      RowVector3d sum(0, 0, 0);
      for (const std::int32_t node : to_.triangles.row(t)) {
        for (const std::int32_t other : fans_.at(node)) {
          const double unlike = (normals_.row(other) - normals_.row(t)).squaredNorm() / (kAlike * kAlike);
          sum += areas_[other] * (first ? 1.0 : std::exp(-0.5 * unlike)) * normals_.row(other);
        }
      }
      const RowVector3d mean = sum.squaredNorm() > 0 ? RowVector3d(sum.normalized()) : RowVector3d(normals_.row(t));
      const bool stays = first == FirstAverage::kOfFolded && mean.dot(normals_.row(t)) > kFolded;
      next.row(t) = stays ? RowVector3d(normals_.row(t)) : mean;
    }
    normals_ = std::move(next);
  }

  [[nodiscard]] Normals node_normals() const {
    Normals outward = Normals::Zero(to_.nodes.rows(), 3);
    for (Eigen::Index t = 0; t < to_.triangles.rows(); ++t) {
      for (const std::int32_t node : to_.triangles.row(t)) outward.row(node) += areas_[t] * normals_.row(t);
    }
    for (auto row : outward.rowwise()) row.normalize();  // zero vectors of unused nodes stay zero
    return outward;
  }

  void move_nodes() {
    Normals next = to_.nodes;
    for (std::int32_t node = 0; node < to_.nodes.rows(); ++node) {
      const auto fan = fans_.at(node);
      if (fan.empty()) continue;
      const RowVector3d at = to_.nodes.row(node);
      RowVector3d way(0, 0, 0), middle(0, 0, 0);
      Eigen::Matrix3d planes = Eigen::Matrix3d::Zero();
      for (const std::int32_t t : fan) {
        const auto row = to_.triangles.row(t);
        const RowVector3d center = (to_.nodes.row(row[0]) + to_.nodes.row(row[1]) + to_.nodes.row(row[2])) / 3;
        way += normals_.row(t) * normals_.row(t).dot(center - at);
        middle += center - at;
        planes += normals_.row(t).transpose() * normals_.row(t);
      }
      way /= static_cast<double>(fan.size());
      middle *= 1.5 / static_cast<double>(fan.size());  // of the neighbours, not of the triangles
      const dense::Spectrum3 axes = dense::spectrum_of_3(planes);
      for (int i = 0; i < 2; ++i) {
        const RowVector3d axis = axes.vectors.col(i).transpose();
        if (axes.values[i] < kFreeShare * axes.values[2]) way += kAlong * middle.dot(axis) * axis;
      }
      next.row(node) += way;
    }
    to_.nodes = std::move(next);
  }

  const TriangleMesh& from_;
  TriangleFans fans_;
  TriangleMesh to_;
  Normals normals_;  // the triangles' target normals
  Eigen::VectorXd areas_;
};

}  // namespace

bool is_folded_by_noise(const TriangleMesh& surface) {
  const auto cuts = self_intersections(surface, kMaxIntersections);
  if (cuts.empty()) return false;
  const Denoising at(surface);
  const auto folds =
      std::count_if(cuts.begin(), cuts.end(), [&at](const auto& pair) { return at.are_neighbours(pair[0], pair[1]); });
  return static_cast<double>(folds) >= kFolds * static_cast<double>(cuts.size()) && at.is_rough();
}

Denoised denoise(const TriangleMesh& surface, FirstAverage first) { return Denoising(surface).run(first); }

}  // namespace ringdown::mesh
