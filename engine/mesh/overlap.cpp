#include "engine/mesh/overlap.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cstdio>
#include <vector>

namespace ringdown::mesh {
namespace {

constexpr int kLeaf = 4;          // elements
constexpr double kInside = 1e-3;  // of an element's height, so far from every face at least

using Box = Eigen::AlignedBox3d;

// By the volumes that the point makes with the faces: no inverse, for most are not inside.
bool is_inside(const Corners& corners, const Eigen::Vector3d& point) {
  const Eigen::Vector3d from = corners.row(0), a = corners.row(1), b = corners.row(2), c = corners.row(3);
  const Eigen::Vector3d u = a - from, v = b - from, w = c - from, p = point - from;
  const Eigen::Vector3d across = v.cross(w);
  const double volume = u.dot(across), first = p.dot(across), least = kInside * volume;
  if (first < least) return false;
  const Eigen::Vector3d turn = u.cross(p);
  const double second = turn.dot(w), third = -turn.dot(v);
  return second > least && third > least && volume - first - second - third > least;
}

// Boxes in boxes: each holds half of the elements of the one above, parted across its longest side. The two halves of
// elements [begin, end) are [begin, middle) and [middle, end), so that a range needs no numbers of children.
class BoxTree {
 public:
  explicit BoxTree(const TetMesh& mesh) : mesh_(mesh) {
    middles_.resize(3, mesh.elements.rows());
    for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
      if (mesh.order() > 1 && !is_straight(nodes_of(mesh, e))) continue;
      order_.push_back(e);
      middles_.col(e) = corners_of(mesh, e).colwise().mean().transpose();
    }
    boxes_.resize(2 * order_.size() + 1);
    build(0, 0, order_.size());
  }

  [[nodiscard]] const std::vector<Eigen::Index>& elements() const { return order_; }
  [[nodiscard]] Eigen::Vector3d middle(Eigen::Index element) const { return middles_.col(element); }

  // Any element but `own` that holds the point; -1 when there is none.
  [[nodiscard]] Eigen::Index find(const Eigen::Vector3d& point, Eigen::Index own) const {
    return find(point, own, 0, 0, order_.size());
  }

 private:
  // A tree over n elements, split into n / 2 and the rest, has fewer than 2 n nodes; those of the first half come
  // first.
  static std::size_t first_child(std::size_t node) { return node + 1; }
  static std::size_t second_child(std::size_t node, std::size_t first_half) { return node + 2 * first_half; }

  void build(std::size_t node, std::size_t begin, std::size_t end) {
    if (end - begin <= kLeaf) {
      for (std::size_t i = begin; i < end; ++i) {
        for (int a = 0; a < 4; ++a) boxes_[node].extend(mesh_.nodes.row(mesh_.elements(order_[i], a)).transpose());
      }
      return;
    }
    Box middles;
    for (std::size_t i = begin; i < end; ++i) middles.extend(middles_.col(order_[i]));
    Eigen::Index axis = 0;
    middles.sizes().maxCoeff(&axis);
    const std::size_t half = (end - begin) / 2;
    const auto at = [this](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(begin + half), at(end),
                     [&](Eigen::Index a, Eigen::Index b) { return middles_(axis, a) < middles_(axis, b); });
    build(first_child(node), begin, begin + half);
    build(second_child(node, half), begin + half, end);
    boxes_[node] = boxes_[first_child(node)].merged(boxes_[second_child(node, half)]);
  }

  [[nodiscard]] Eigen::Index find(const Eigen::Vector3d& point, Eigen::Index own, std::size_t node, std::size_t begin,
                                  std::size_t end) const {
    if (!boxes_[node].contains(point)) return -1;
    if (end - begin <= kLeaf) {
      for (std::size_t i = begin; i < end; ++i) {
        if (order_[i] != own && is_inside(corners_of(mesh_, order_[i]), point)) return order_[i];
      }
      return -1;
    }
    const std::size_t half = (end - begin) / 2;
    const Eigen::Index found = find(point, own, first_child(node), begin, begin + half);
    return found >= 0 ? found : find(point, own, second_child(node, half), begin + half, end);
  }

  const TetMesh& mesh_;
  Eigen::Matrix3Xd middles_;  // of all elements
  std::vector<Eigen::Index> order_;
  std::vector<Box> boxes_;
};

}  // namespace

Result<void> check_overlap(const TetMesh& mesh, const std::string& name) {
  const BoxTree tree(mesh);
  for (const Eigen::Index element : tree.elements()) {
    const Eigen::Vector3d middle = tree.middle(element);
    if (tree.find(middle, element) < 0) continue;
    char place[96];
    std::snprintf(place, sizeof place, "(%.6g, %.6g, %.6g) m", middle[0], middle[1], middle[2]);
    return fail(ErrorKind::bad_input,
                name + ": elements overlap at " + place +
                    "; a body given twice, or two that run through each other: delete or unite them, and mesh again");
  }
  return {};
}

}  // namespace ringdown::mesh
