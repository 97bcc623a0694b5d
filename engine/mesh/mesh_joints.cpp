#include "engine/mesh/mesh_joints.h"

#include "engine/base/groups.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>
#include <vector>

namespace ringdown::mesh {
namespace {

struct Face {
  std::array<std::int32_t, 3> corners;  // ascending
  bool turned;                          // true: seen from outside, the ascending order turns clockwise
  std::int8_t number;                   // position in kTetFaces
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

// Returns all faces of all elements; equal faces are adjacent, the lower element first.
std::vector<Face> sorted_faces(const TetMesh& mesh) {
  std::vector<Face> faces;
  faces.reserve(4 * static_cast<std::size_t>(mesh.elements.rows()));
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    for (int f = 0; f < 4; ++f) faces.push_back(face_of(mesh, e, f));
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return a.corners != b.corners ? a.corners < b.corners : a.element < b.element;
  });
  return faces;
}

// Removes the marked elements; returns how many.
int remove(TetMesh& mesh, const std::vector<bool>& marked) {
  Eigen::Index kept = 0;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    if (!marked[e]) mesh.elements.row(kept++) = mesh.elements.row(e).eval();
  }
  const auto removed = static_cast<int>(mesh.elements.rows() - kept);
  mesh.elements.conservativeResize(kept, Eigen::NoChange);
  return removed;
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
  return remove(mesh, copy);
}

int count_pieces(const TetMesh& mesh) {
  Groups<std::int32_t> groups(static_cast<std::size_t>(mesh.nodes.rows()));
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    for (Eigen::Index a = 1; a < mesh.elements.cols(); ++a) groups.join(mesh.elements(e, a), mesh.elements(e, 0));
  }
  int pieces = 0;
  for (std::int32_t node = 0; node < mesh.nodes.rows(); ++node) pieces += groups.root(node) == node;
  return pieces;
}

// Checking how elements meet
//
// All faces are sorted by their corners, so that the faces of neighbours are adjacent. A face may occur once (on the
// boundary) or twice with opposite turns (inside); anything else is an overlap. Each inner face joins its two elements
// around each of the face's nodes. The elements around a node then form one fan if all are connected through faces at
// that node; two fans at one node are parts that touch in a point only. An edge of the boundary has two outer faces;
// four mean that parts touch along that edge.
namespace {

std::string position_text(const Eigen::RowVector3d& at) {
  return formatted("({:.6g}, {:.6g}, {:.6g}) m", at[0], at[1], at[2]);
}

std::string position_text(const TetMesh& mesh, const Face& face) {
  const auto& [a, b, c] = face.corners;
  return position_text((mesh.nodes.row(a) + mesh.nodes.row(b) + mesh.nodes.row(c)) / 3);
}

// A slot for each node of each element. Slots of one node belong to one fan if faces around that node connect their
// elements.
class Fans {
 public:
  explicit Fans(const TetMesh& mesh) : mesh_(mesh), groups_(static_cast<std::size_t>(mesh.elements.size())) {
    const Barycentric points = reference_nodes(mesh.order());
    for (int f = 0; f < 4; ++f) {
      for (int a = 0; a < points.rows(); ++a) {
        if (points(a, f) == 0) on_face_[f].push_back(a);
      }
    }
  }

  // Joins the fans around all nodes of a common face. Returns false if the elements do not share all nodes of the face.
  bool join(const Face& a, const Face& b) {
    const std::vector<Eigen::Index> first = slots(a), second = slots(b);
    for (std::size_t k = 0; k < first.size(); ++k) {
      if (node(first[k]) != node(second[k])) return false;
      groups_.join(first[k], second[k]);
    }
    return true;
  }

  // Returns a node with more than one fan; -1 if there is none.
  std::int32_t parted_node() {
    std::vector<Eigen::Index> fan(mesh_.nodes.rows(), -1);
    for (Eigen::Index slot = 0; slot < mesh_.elements.size(); ++slot) {
      Eigen::Index& known = fan[node(slot)];
      if (known < 0) known = groups_.root(slot);
      if (known != groups_.root(slot)) return node(slot);
    }
    return -1;
  }

 private:
  [[nodiscard]] std::int32_t node(Eigen::Index slot) const { return mesh_.elements.data()[slot]; }

  // The slots of the face's nodes, by ascending numbers of the nodes.
  [[nodiscard]] std::vector<Eigen::Index> slots(const Face& face) const {
    std::vector<Eigen::Index> slots;
    for (const int a : on_face_[face.number]) slots.push_back(face.element * mesh_.elements.cols() + a);
    std::sort(slots.begin(), slots.end(), [this](Eigen::Index a, Eigen::Index b) { return node(a) < node(b); });
    return slots;
  }

  const TetMesh& mesh_;
  Groups<Eigen::Index> groups_;
  std::array<std::vector<int>, 4> on_face_;
};

// An edge of the boundary has as many fans of elements as pairs of outer faces, so each edge must have just one pair.
Result<void> check_edges(const TetMesh& mesh, const std::vector<Face>& outer, const std::string& name) {
  std::vector<std::array<std::int32_t, 2>> edges;
  for (const auto& [corners, turned, number, element] : outer) {
    edges.insert(edges.end(), {{corners[0], corners[1]}, {corners[0], corners[2]}, {corners[1], corners[2]}});
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i + 2 < edges.size(); i += 2) {
    if (edges[i] != edges[i + 2]) continue;
    return fail(ErrorKind::bad_input,
                "{}: parts of the body touch only along an edge from {} to {}, like a hinge; join them by a face, or "
                "give each its own nodes",
                name, position_text(mesh.nodes.row(edges[i][0])), position_text(mesh.nodes.row(edges[i][1])));
  }
  return {};
}

}  // namespace

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
                  "{}: elements overlap at their common face at {}; the mesh is tangled: mesh the object again, or "
                  "repair it in a mesh tool",
                  name, position_text(mesh, faces[i]));
    }
    if (!fans.join(faces[i], faces[i + 1])) {
      return fail(ErrorKind::bad_input,
                  "{}: two elements share the corners of their face at {} but not its other nodes; merge the nodes of "
                  "the mesh, or mesh the object again",
                  name, position_text(mesh, faces[i]));
    }
  }
  if (auto good = check_edges(mesh, outer, name); !good) return good;
  if (const std::int32_t node = fans.parted_node(); node >= 0) {
    return fail(ErrorKind::bad_input,
                "{}: parts of the body touch only in the point {}, like a hinge; join them by a face, or give each its "
                "own node",
                name, position_text(mesh.nodes.row(node)));
  }
  return {};
}

// Keeping the sound parts
//
// Elements are joined by the faces that they share. First, parts of too few elements are removed. Then the groups of
// elements connected through faces are found around every corner and every edge; if there is more than one group, all
// but the largest are removed. Removing elements may create new small parts or hinges, so the two steps alternate until
// nothing is removed.
namespace {

// Two elements with a face in common.
struct Joint {
  std::array<std::int32_t, 3> corners;  // ascending
  int a, b;
};

std::vector<Joint> joints_of(const TetMesh& mesh) {
  const std::vector<Face> faces = sorted_faces(mesh);
  std::vector<Joint> joints;
  for (std::size_t f = 1; f < faces.size(); ++f) {
    if (faces[f].corners != faces[f - 1].corners) continue;
    joints.push_back({faces[f].corners, faces[f - 1].element, faces[f].element});
  }
  return joints;
}

// One corner or edge of one element. Slots of one corner or edge are joined if a face connects their elements.
struct Slot {
  std::array<std::int32_t, 2> what;  // a corner's node twice, or the two nodes of an edge, ascending
  int element;
  auto key() const { return std::tie(what, element); }
};

// Marks, around every corner and edge, the elements of all groups but the largest. Returns the number of marked
// elements.
int mark_hinges(const TetMesh& mesh, const std::vector<Joint>& joints, std::vector<bool>& gone) {
  std::vector<Slot> slots;
  slots.reserve(10 * mesh.elements.rows());
  for (int e = 0; e < mesh.elements.rows(); ++e) {
    for (int a = 0; a < 4; ++a) {
      for (int b = a; b < 4; ++b) {
        const auto [low, high] = std::minmax({mesh.elements(e, a), mesh.elements(e, b)});
        slots.push_back({{low, high}, e});
      }
    }
  }
  const auto before = [](const Slot& x, const Slot& y) { return x.key() < y.key(); };
  std::sort(slots.begin(), slots.end(), before);
  Groups<int> groups(slots.size());
  const auto slot_of = [&](std::int32_t a, std::int32_t b, int element) {
    return static_cast<int>(std::lower_bound(slots.begin(), slots.end(), Slot{{a, b}, element}, before) -
                            slots.begin());
  };
  for (const Joint& joint : joints) {
    for (int a = 0; a < 3; ++a) {
      for (int b = a; b < 3; ++b) {
        groups.join(slot_of(joint.corners[a], joint.corners[b], joint.a),
                    slot_of(joint.corners[a], joint.corners[b], joint.b));
      }
    }
  }
  int marked = 0;
  for (std::size_t first = 0, next; first < slots.size(); first = next) {
    for (next = first; next < slots.size() && slots[next].what == slots[first].what;) ++next;
    std::vector<int> size(next - first, 0);
    for (std::size_t s = first; s < next; ++s) ++size[groups.root(static_cast<int>(s)) - first];
    const auto max = std::max_element(size.begin(), size.end());
    if (*max == static_cast<int>(next - first)) continue;
    for (std::size_t s = first; s < next; ++s) {
      if (groups.root(static_cast<int>(s)) == static_cast<int>(first + (max - size.begin()))) continue;
      if (gone[slots[s].element]) continue;
      gone[slots[s].element] = true;
      ++marked;
    }
  }
  return marked;
}

// Marks parts of fewer than `min` elements, never the largest.
int mark_crumbs(const TetMesh& mesh, const std::vector<Joint>& joints, int min, std::vector<bool>& gone) {
  Groups<int> parts(mesh.elements.rows());
  for (const Joint& joint : joints) parts.join(joint.a, joint.b);
  std::vector<int> size(mesh.elements.rows(), 0);
  for (int e = 0; e < mesh.elements.rows(); ++e) ++size[parts.root(e)];
  const auto largest = static_cast<int>(std::max_element(size.begin(), size.end()) - size.begin());
  int crumbs = 0;
  for (int e = 0; e < mesh.elements.rows(); ++e) {
    const int part = parts.root(e);
    if (part == largest || size[part] >= min) continue;
    crumbs += part == e;
    gone[e] = true;
  }
  return crumbs;
}

}  // namespace

Trimmed keep_sound_parts(TetMesh& mesh, int min) {
  Trimmed trimmed;
  while (mesh.elements.rows() > 0) {
    const std::vector<Joint> joints = joints_of(mesh);
    std::vector<bool> gone(mesh.elements.rows(), false);
    const int crumbs = mark_crumbs(mesh, joints, min, gone);
    const int hinges = crumbs > 0 ? 0 : mark_hinges(mesh, joints, gone);
    if (crumbs + hinges == 0) break;
    trimmed.crumbs += crumbs;
    trimmed.hinges += hinges;
    remove(mesh, gone);
  }
  drop_unused_nodes(mesh.nodes, mesh.elements);
  return trimmed;
}

}  // namespace ringdown::mesh
