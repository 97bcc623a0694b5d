#include "engine/mesh/mesh_joints.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <numeric>
#include <vector>

namespace ringdown::mesh {
namespace {

struct Face {
  std::array<std::int32_t, 3> corners;  // ascending
  bool turned;                          // seen from outside, the ascending order turns clockwise
  std::int8_t number;                   // in kTetFaces
  std::int32_t element;
};

Face face_of(const TetMesh& mesh, Eigen::Index element, int number) {
  const auto& [a, b, c] = kTetFaces[number];
  std::array<std::int32_t, 3> corners = {mesh.elements(element, a), mesh.elements(element, b),
                                         mesh.elements(element, c)};
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  const bool turned = corners[1] > corners[2];
  if (turned) std::swap(corners[1], corners[2]);
  return {corners, turned, static_cast<std::int8_t>(number), static_cast<std::int32_t>(element)};
}

// Equal faces side by side.
std::vector<Face> sorted_faces(const TetMesh& mesh) {
  std::vector<Face> faces;
  faces.reserve(4 * static_cast<std::size_t>(mesh.elements.rows()));
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    for (int f = 0; f < 4; ++f) faces.push_back(face_of(mesh, e, f));
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.corners < b.corners; });
  return faces;
}

std::string place(const Eigen::RowVector3d& at) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.6g, %.6g, %.6g) m", at[0], at[1], at[2]);
  return text;
}

std::string place(const TetMesh& mesh, const Face& face) {
  const auto& [a, b, c] = face.corners;
  return place((mesh.nodes.row(a) + mesh.nodes.row(b) + mesh.nodes.row(c)) / 3);
}

// The corners of elements, joined where one comes from one to the other through faces around the same node.
class Fans {
 public:
  explicit Fans(const TetMesh& mesh) : mesh_(mesh), parent_(mesh.elements.size()) {
    std::iota(parent_.begin(), parent_.end(), 0);
    const Lattice points = lattice(mesh.order());
    for (int f = 0; f < 4; ++f) {
      for (int a = 0; a < points.rows(); ++a) {
        if (points(a, f) == 0) on_face_[f].push_back(a);
      }
    }
  }

  // False when the two do not have all nodes of the face in common.
  bool join(const Face& a, const Face& b) {
    const std::vector<Eigen::Index> first = slots(a), second = slots(b);
    for (std::size_t k = 0; k < first.size(); ++k) {
      if (node(first[k]) != node(second[k])) return false;
      parent_[root(first[k])] = root(second[k]);
    }
    return true;
  }

  // A node whose elements are not all joined; -1 when there is none.
  std::int32_t parted_node() {
    std::vector<Eigen::Index> fan(mesh_.nodes.rows(), -1);
    for (Eigen::Index slot = 0; slot < mesh_.elements.size(); ++slot) {
      Eigen::Index& known = fan[node(slot)];
      if (known < 0) known = root(slot);
      if (known != root(slot)) return node(slot);
    }
    return -1;
  }

 private:
  [[nodiscard]] std::int32_t node(Eigen::Index slot) const { return mesh_.elements.data()[slot]; }

  // Of the face's nodes, ascending by their numbers.
  [[nodiscard]] std::vector<Eigen::Index> slots(const Face& face) const {
    std::vector<Eigen::Index> slots;
    for (const int a : on_face_[face.number]) slots.push_back(face.element * mesh_.elements.cols() + a);
    std::sort(slots.begin(), slots.end(), [this](Eigen::Index a, Eigen::Index b) { return node(a) < node(b); });
    return slots;
  }

  Eigen::Index root(Eigen::Index slot) {
    while (parent_[slot] != slot) slot = parent_[slot] = parent_[parent_[slot]];
    return slot;
  }

  const TetMesh& mesh_;
  std::vector<Eigen::Index> parent_;
  std::array<std::vector<int>, 4> on_face_;
};

// Around an edge of the boundary run as many fans of elements as it has pairs of outer faces.
Result<void> check_edges(const TetMesh& mesh, const std::vector<Face>& outer, const std::string& name) {
  std::vector<std::array<std::int32_t, 2>> edges;
  for (const auto& [corners, turned, number, element] : outer) {
    edges.insert(edges.end(), {{corners[0], corners[1]}, {corners[0], corners[2]}, {corners[1], corners[2]}});
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i + 2 < edges.size(); i += 2) {
    if (edges[i] != edges[i + 2]) continue;
    return fail(ErrorKind::bad_input, name + ": parts of the body touch only along an edge from " +
                                          place(mesh.nodes.row(edges[i][0])) + " to " +
                                          place(mesh.nodes.row(edges[i][1])) +
                                          ", like a hinge; join them by a face, or give each its own nodes");
  }
  return {};
}

}  // namespace

int drop_duplicates(TetMesh& mesh) {
  Indices nodes = mesh.elements;
  for (auto row : nodes.rowwise()) std::sort(row.begin(), row.end());
  std::vector<Eigen::Index> order(nodes.rows());
  std::iota(order.begin(), order.end(), 0);
  const auto before = [&](Eigen::Index a, Eigen::Index b) {
    const auto x = nodes.row(a), y = nodes.row(b);
    return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
  };
  std::stable_sort(order.begin(), order.end(), before);
  std::vector<bool> copy(nodes.rows(), false);
  for (std::size_t k = 1; k < order.size(); ++k) copy[order[k]] = nodes.row(order[k - 1]) == nodes.row(order[k]);
  Eigen::Index kept = 0;
  for (Eigen::Index e = 0; e < nodes.rows(); ++e) {
    if (!copy[e]) mesh.elements.row(kept++) = mesh.elements.row(e).eval();
  }
  const auto dropped = static_cast<int>(nodes.rows() - kept);
  mesh.elements.conservativeResize(kept, Eigen::NoChange);
  return dropped;
}

Result<void> check_joints(const TetMesh& mesh, const std::string& name) {
  const std::vector<Face> faces = sorted_faces(mesh);
  std::vector<Face> outer;
  Fans fans(mesh);
  for (std::size_t i = 0, next; i < faces.size(); i = next) {
    for (next = i + 1; next < faces.size() && faces[next].corners == faces[i].corners;) ++next;
    if (next == i + 1) {
      outer.push_back(faces[i]);
      continue;
    }
    if (next > i + 2 || faces[i].turned == faces[i + 1].turned) {
      return fail(ErrorKind::bad_input,
                  name + ": elements overlap at their common face at " + place(mesh, faces[i]) +
                      "; the mesh is tangled: mesh the object again, or repair it in a mesh tool");
    }
    if (!fans.join(faces[i], faces[i + 1])) {
      return fail(ErrorKind::bad_input,
                  name + ": two elements share the corners of their face at " + place(mesh, faces[i]) +
                      " but not its other nodes; merge the nodes of the mesh, or mesh the object again");
    }
  }
  if (auto good = check_edges(mesh, outer, name); !good) return good;
  if (const std::int32_t node = fans.parted_node(); node >= 0) {
    return fail(ErrorKind::bad_input, name + ": parts of the body touch only in the point " +
                                          place(mesh.nodes.row(node)) +
                                          ", like a hinge; join them by a face, or give each its own node");
  }
  return {};
}

}  // namespace ringdown::mesh
