#include "engine/mesh/stuffing/sharpen.h"

#include "engine/dense/decompositions.h"
#include "engine/mesh/stuffing/bcc_lattice.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <vector>

// Sharpening, round by round
//
// Each node of the boundary gets the plane of the triangle on which it lies. If the planes of a node's neighbours
// differ by more than a sharp angle, the point nearest to all planes (least squares) is on the edge or corner that the
// lattice cut off. This point is the node's target. Nodes move to their targets, the nearest first; a node whose
// elements would get too flat angles moves half of the way or stays. Moving one node changes the possible moves of its
// neighbours, so there are a few rounds.
namespace ringdown::mesh {
namespace {

using Eigen::Vector3d;

constexpr double kSharpCosine = 0.82, kFit = 0.05, kMaxMove = 0.8, kMinMove = 0.01;  // of the size
constexpr int kRounds = 3;

struct Plane {
  Vector3d point, normal;
  bool known = false;
};

class Sharpener {
 public:
  Sharpener(TetMesh& mesh, const WindingNumber& surface, double size) : mesh_(mesh), size_(size) {
    find_skin();
    for (const auto& [node, ring] : rings_) {
      Plane& plane = planes_[node];
      plane.point = at(node);
      plane.known = surface.normal_at(plane.point, 1e-4 * size, plane.normal);
    }
  }

  int run() {
    std::set<int> moved;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<std::pair<double, int>> order;
      std::map<int, Vector3d> targets;
      for (const auto& [node, ring] : rings_) {
        Vector3d target;
        if (!find_target(node, ring, target)) continue;
        order.emplace_back((target - at(node)).norm(), node);
        targets[node] = target;
      }
      std::sort(order.begin(), order.end());
      for (const auto& [distance, node] : order) {
        if (move(node, targets[node]) || move(node, (targets[node] + at(node)) / 2)) moved.insert(node);
      }
    }
    return static_cast<int>(moved.size());
  }

 private:
  [[nodiscard]] Vector3d at(int node) const { return mesh_.nodes.row(node).transpose(); }

  void find_skin() {
    std::map<std::array<std::int32_t, 3>, int> faces;
    for (Eigen::Index e = 0; e < mesh_.elements.rows(); ++e) {
      for (const auto& corners : kTetFaces) ++faces[face(e, corners)];
    }
    for (const auto& [nodes, count] : faces) {
      if (count != 1) continue;
      for (const std::int32_t a : nodes) rings_[a].insert(nodes.begin(), nodes.end());
    }
    for (Eigen::Index e = 0; e < mesh_.elements.rows(); ++e) {
      for (int c = 0; c < 4; ++c) {
        if (rings_.contains(mesh_.elements(e, c))) elements_[mesh_.elements(e, c)].push_back(e);
      }
    }
  }

  [[nodiscard]] std::array<std::int32_t, 3> face(Eigen::Index e, const std::array<int, 3>& corners) const {
    std::array<std::int32_t, 3> nodes;
    for (int k = 0; k < 3; ++k) nodes[k] = mesh_.elements(e, corners[k]);
    std::sort(nodes.begin(), nodes.end());
    return nodes;
  }

  // Finds the point nearest to the node that lies on all planes around it: least squares without the directions that
  // the planes leave undetermined (Kobbelt et al., Feature Sensitive Surface Extraction, SIGGRAPH 2001).
  bool find_target(int node, const std::set<std::int32_t>& ring, Vector3d& target) const {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Vector3d right = Vector3d::Zero();
    double min = 1;
    const Plane& own = planes_.at(node);
    if (!own.known) return false;
    for (const int other : ring) {
      const Plane& plane = planes_.at(other);
      if (!plane.known) return false;
      min = std::min(min, plane.normal.dot(own.normal));
      normal += plane.normal * plane.normal.transpose();
      right += plane.normal * plane.normal.dot(plane.point - at(node));
    }
    if (min > kSharpCosine) return false;
    const dense::Spectrum3 solver = dense::spectrum_of_3(normal);
    Vector3d step = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      if (solver.values[k] < 0.03 * solver.values[2]) continue;
      const Vector3d direction = solver.vectors.col(k);
      step += direction * direction.dot(right) / solver.values[k];
    }
    target = at(node) + step;
    if (step.norm() < kMinMove * size_ || (target - own.point).norm() > kMaxMove * size_) return false;
    return std::all_of(ring.begin(), ring.end(), [&](int other) {
      const Plane& plane = planes_.at(other);
      return std::abs(plane.normal.dot(target - plane.point)) < kFit * size_;
    });
  }

  bool move(int node, const Vector3d& target) {
    const Vector3d before = at(node);
    mesh_.nodes.row(node) = target.transpose();
    const auto& around = elements_.at(node);
    if (std::all_of(around.begin(), around.end(), [this](Eigen::Index e) { return good(e); })) return true;
    mesh_.nodes.row(node) = before.transpose();
    return false;
  }

  [[nodiscard]] bool good(Eigen::Index e) const {
    const Corners x = corners_of(mesh_, e);
    if (jacobian(x).determinant() <= 0) return false;
    std::array<Vector3d, 4> outward;
    for (int f = 0; f < 4; ++f) {
      const auto& [a, b, c] = kTetFaces[f];
      const Vector3d u = (x.row(b) - x.row(a)).transpose(), v = (x.row(c) - x.row(a)).transpose();
      outward[f] = u.cross(v).normalized();
    }
    constexpr double kDegree = std::numbers::pi / 180;
    static const double narrow = std::cos(kMinDihedral * kDegree), wide = std::cos(kMaxDihedral * kDegree);
    for (int f = 0; f < 4; ++f) {
      for (int g = 0; g < f; ++g) {
        const double cosine = -outward[f].dot(outward[g]);
        if (!(cosine < narrow && cosine > wide)) return false;
      }
    }
    return true;
  }

  TetMesh& mesh_;
  double size_;
  std::map<std::int32_t, std::set<std::int32_t>> rings_;
  std::map<std::int32_t, Plane> planes_;
  std::map<std::int32_t, std::vector<Eigen::Index>> elements_;
};

}  // namespace

int sharpen(TetMesh& mesh, const WindingNumber& surface, double size_m) {
  return Sharpener(mesh, surface, size_m).run();
}

}  // namespace ringdown::mesh
