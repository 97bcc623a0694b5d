#include "engine/mesh/mesh_check.h"

#include "engine/mesh/mesh_joints.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace ringdown::mesh {

// Overlaps
//
// Two bodies that occupy one space share no face, so a comparison of neighbours does not find them. The middle
// of every straight element is therefore looked up among all others. A tree of bounding boxes, which halves the
// elements along the longest side of the box around their middles, leads to the few elements whose box holds the point.
namespace {

constexpr int kLeafElements = 4;
constexpr double kInside = 1e-3;  // least distance from every face, as a share of the element's height

using Box = Eigen::AlignedBox3d;

// Compares the volumes between the point and the four faces, without a matrix inverse: most points fail at the first.
bool is_inside(const Corners& corners, const Eigen::Vector3d& point) {
  const Eigen::Vector3d from = corners.row(0), a = corners.row(1), b = corners.row(2), c = corners.row(3);
  const Eigen::Vector3d u = a - from, v = b - from, w = c - from, p = point - from;
  const Eigen::Vector3d across = v.cross(w);
  const double volume = u.dot(across), first = p.dot(across), min = kInside * volume;
  if (first < min) return false;
  const Eigen::Vector3d turn = u.cross(p);
  const double second = turn.dot(w), third = -turn.dot(v);
  return second > min && third > min && volume - first - second - third > min;
}

// A tree of boxes. Each box holds half of its parent's elements, divided across the parent's longest side. The two
// halves of elements [begin, end) are [begin, middle) and [middle, end), so the numbers of children need not be stored.
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

  // Returns any element but `own` that holds the point; -1 if there is none.
  [[nodiscard]] Eigen::Index find(const Eigen::Vector3d& point, Eigen::Index own) const {
    return find(point, own, 0, 0, order_.size());
  }

 private:
  // A tree over n elements, split into n / 2 and the rest, has fewer than 2 n nodes; those of the first half come
  // first.
  static std::size_t first_child(std::size_t node) { return node + 1; }
  static std::size_t second_child(std::size_t node, std::size_t first_half) { return node + 2 * first_half; }

  void build(std::size_t node, std::size_t begin, std::size_t end) {
    if (end - begin <= kLeafElements) {
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
    if (end - begin <= kLeafElements) {
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
    const std::string place = formatted("({:.6g}, {:.6g}, {:.6g}) m", middle[0], middle[1], middle[2]);
    return fail(ErrorKind::bad_input,
                "{}: elements overlap at {}; a body appears twice, or two bodies intersect: delete or unite them, and "
                "mesh again",
                name, place);
  }
  return {};
}

// The whole check
//
// The order matters: node numbers are checked before they are used as indices, orientation is repaired before faces are
// compared by their orientation, duplicates are dropped before they would be reported as overlaps, and curvature is
// repaired last, because that moves nodes.
namespace {

// The determinant of an equilateral tetrahedron of edge h is h^3 / sqrt(2); below 1e-9 h^3 an element counts as flat.
bool is_flat(const Corners& corners, double determinant) {
  double longest = 0;
  for (const auto& [i, j] : kTetEdges) longest = std::max(longest, (corners.row(i) - corners.row(j)).norm());
  return !(std::abs(determinant) > 1e-9 * longest * longest * longest);
}

// Returns the order of nodes that exchanges corners 1 and 2: the new node k is the old node nodes[k].
std::vector<int> flipped_nodes(int order) {
  Barycentric points = reference_nodes(order);
  points.col(1).swap(points.col(2));
  return nodes_at(order, points);
}

Result<void> check_numbers(const TetMesh& mesh, const std::string& name) {
  if (mesh.elements.rows() == 0) {
    return fail(ErrorKind::bad_input,
                name + " has no tetrahedra; a solid is needed, so mesh its volume, not only its surface");
  }
  if (mesh.order() == 0) {
    return fail(ErrorKind::bad_input, "{} has elements of {} nodes; give tetrahedra of 4, 10, 20 or 35 nodes", name,
                mesh.elements.cols());
  }
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    for (const std::int32_t node : mesh.elements.row(e)) {
      if (node >= 0 && node < mesh.nodes.rows()) continue;
      return fail(ErrorKind::bad_input, "{}: element {} names node {}, but there are only {}", name, e, node,
                  mesh.nodes.rows());
    }
  }
  std::vector<std::int32_t> own(mesh.elements.cols());
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    std::copy(mesh.elements.row(e).begin(), mesh.elements.row(e).end(), own.begin());
    std::sort(own.begin(), own.end());
    if (const auto twice = std::adjacent_find(own.begin(), own.end()); twice != own.end()) {
      return fail(ErrorKind::bad_input,
                  "{}: element {} names node {} twice; mesh the object again, or repair it in a mesh tool", name, e,
                  *twice);
    }
  }
  for (Eigen::Index node = 0; node < mesh.nodes.rows(); ++node) {
    if (!mesh.nodes.row(node).allFinite()) {
      return fail(ErrorKind::bad_input, "{}: a coordinate of node {} is not a finite number", name, node);
    }
  }
  return {};
}

}  // namespace

Result<CheckedMesh> check_mesh(TetMesh mesh, const std::string& name) {
  if (auto numbers = check_numbers(mesh, name); !numbers) return fail(numbers);
  CheckedMesh checked{.mesh = std::move(mesh)};
  checked.unused_nodes = drop_unused_nodes(checked.mesh.nodes, checked.mesh.elements);
  const std::vector<int> flipped = flipped_nodes(checked.mesh.order());
  for (Eigen::Index e = 0; e < checked.mesh.elements.rows(); ++e) {
    const Corners corners = corners_of(checked.mesh, e);
    const double determinant = jacobian(corners).determinant();
    if (is_flat(corners, determinant)) {
      return fail(ErrorKind::bad_input,
                  "{}: element {} has no volume (its four corners lie in a plane); mesh the object again, or repair it "
                  "in a mesh tool",
                  name, e);
    }
    if (determinant > 0) continue;
    checked.mesh.elements.row(e) = checked.mesh.elements(e, flipped).eval();
    ++checked.flipped;
  }
  checked.duplicates = drop_duplicates(checked.mesh);
  if (auto joints = check_joints(checked.mesh, name); !joints) return fail(joints);
  if (auto apart = check_overlap(checked.mesh, name); !apart) return fail(apart);
  checked.straightened = straighten_folded(checked.mesh);
  checked.pieces = count_pieces(checked.mesh);
  return checked;
}

}  // namespace ringdown::mesh
