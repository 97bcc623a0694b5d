#include "engine/mesh/mesh_parts.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

namespace ringdown::mesh {
namespace {

constexpr std::array<std::array<int, 3>, 4> kFaces = kTetFaces;

class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int root(int item) {
    while (parent_[item] != item) item = parent_[item] = parent_[parent_[item]];
    return item;
  }
  void join(int a, int b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

struct Face {
  std::array<std::int32_t, 3> nodes;  // ascending
  int element;
};

// Pairs of elements with a face in common.
struct Joint {
  std::array<std::int32_t, 3> nodes;
  int a, b;
};

std::vector<Joint> joints_of(const TetMesh& mesh) {
  std::vector<Face> faces;
  faces.reserve(4 * mesh.elements.rows());
  for (int e = 0; e < mesh.elements.rows(); ++e) {
    for (const auto& [a, b, c] : kFaces) {
      Face face{{mesh.elements(e, a), mesh.elements(e, b), mesh.elements(e, c)}, e};
      std::sort(face.nodes.begin(), face.nodes.end());
      faces.push_back(face);
    }
  }
  std::sort(faces.begin(), faces.end(), [](const Face& x, const Face& y) {
    return x.nodes != y.nodes ? x.nodes < y.nodes : x.element < y.element;
  });
  std::vector<Joint> joints;
  for (std::size_t f = 1; f < faces.size(); ++f) {
    if (faces[f].nodes == faces[f - 1].nodes)
      joints.push_back({faces[f].nodes, faces[f - 1].element, faces[f].element});
  }
  return joints;
}

// One corner or edge of one element; slots of the same corner or edge are joined where a face leads from one to the
// other.
struct Slot {
  std::array<std::int32_t, 2> what;  // a node twice, or the two of an edge, ascending
  int element;
  auto key() const { return std::tie(what, element); }
};

// Marks the elements of all groups around a corner or an edge but the largest.
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
  Groups groups(slots.size());
  const auto slot_of = [&](std::int32_t a, std::int32_t b, int element) {
    return static_cast<int>(std::lower_bound(slots.begin(), slots.end(), Slot{{a, b}, element}, before) -
                            slots.begin());
  };
  for (const Joint& joint : joints) {
    for (int a = 0; a < 3; ++a) {
      for (int b = a; b < 3; ++b) {
        groups.join(slot_of(joint.nodes[a], joint.nodes[b], joint.a), slot_of(joint.nodes[a], joint.nodes[b], joint.b));
      }
    }
  }
  int marked = 0;
  for (std::size_t first = 0, next; first < slots.size(); first = next) {
    for (next = first; next < slots.size() && slots[next].what == slots[first].what;) ++next;
    std::vector<int> size(next - first, 0);
    for (std::size_t s = first; s < next; ++s) ++size[groups.root(static_cast<int>(s)) - first];
    const auto most = std::max_element(size.begin(), size.end());
    if (*most == static_cast<int>(next - first)) continue;
    for (std::size_t s = first; s < next; ++s) {
      if (groups.root(static_cast<int>(s)) == static_cast<int>(first + (most - size.begin()))) continue;
      if (gone[slots[s].element]) continue;
      gone[slots[s].element] = true;
      ++marked;
    }
  }
  return marked;
}

// Marks parts of fewer than `least` elements, never the largest.
int mark_crumbs(const TetMesh& mesh, const std::vector<Joint>& joints, int least, std::vector<bool>& gone) {
  Groups parts(mesh.elements.rows());
  for (const Joint& joint : joints) parts.join(joint.a, joint.b);
  std::vector<int> size(mesh.elements.rows(), 0);
  for (int e = 0; e < mesh.elements.rows(); ++e) ++size[parts.root(e)];
  const auto largest = static_cast<int>(std::max_element(size.begin(), size.end()) - size.begin());
  int crumbs = 0;
  for (int e = 0; e < mesh.elements.rows(); ++e) {
    const int part = parts.root(e);
    if (part == largest || size[part] >= least) continue;
    crumbs += part == e;
    gone[e] = true;
  }
  return crumbs;
}

void remove(TetMesh& mesh, const std::vector<bool>& gone) {
  Eigen::Index kept = 0;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    if (!gone[e]) mesh.elements.row(kept++) = mesh.elements.row(e).eval();
  }
  mesh.elements.conservativeResize(kept, Eigen::NoChange);
}

void drop_unused_nodes(TetMesh& mesh) {
  std::vector<std::int32_t> number(mesh.nodes.rows(), -1);
  for (const std::int32_t node : mesh.elements.reshaped()) number[node] = 0;
  std::int32_t kept = 0;
  for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n) {
    if (number[n] < 0) continue;
    mesh.nodes.row(kept) = mesh.nodes.row(n).eval();
    number[n] = kept++;
  }
  mesh.nodes.conservativeResize(kept, Eigen::NoChange);
  for (std::int32_t& node : mesh.elements.reshaped()) node = number[node];
}

}  // namespace

Trimmed keep_sound_parts(TetMesh& mesh, int least) {
  Trimmed trimmed;
  while (mesh.elements.rows() > 0) {
    const std::vector<Joint> joints = joints_of(mesh);
    std::vector<bool> gone(mesh.elements.rows(), false);
    const int crumbs = mark_crumbs(mesh, joints, least, gone);
    const int hinges = crumbs > 0 ? 0 : mark_hinges(mesh, joints, gone);
    if (crumbs + hinges == 0) break;
    trimmed.crumbs += crumbs;
    trimmed.hinges += hinges;
    remove(mesh, gone);
  }
  drop_unused_nodes(mesh);
  return trimmed;
}

}  // namespace ringdown::mesh
