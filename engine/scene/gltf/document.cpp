#include "engine/scene/gltf/document.h"

#include "engine/base/quote.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ringdown::scene {
namespace {

using modal::JsonPlace;

constexpr std::size_t kMaxNotes = 64;
constexpr std::size_t kMaxSkinPoints = std::size_t{1} << 20;
constexpr double kMaxShear = 1e-6;  // cosine of the angle between columns, as far as rounding makes it

Vec3 column(const Matrix3& m, int k) { return {m[0][k], m[1][k], m[2][k]}; }

Matrix3 from_columns(Vec3 x, Vec3 y, Vec3 z) { return {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}}; }

Matrix3 scaled(const Matrix3& m, Vec3 s) {
  return from_columns(s.x * column(m, 0), s.y * column(m, 1), s.z * column(m, 2));
}

// The quaternion of a rotation matrix, by the largest of its four components (Shepperd 1978).
Rotation to_rotation(const Matrix3& m) {
  const std::array squares{1 + m[0][0] - m[1][1] - m[2][2], 1 - m[0][0] + m[1][1] - m[2][2],
                           1 - m[0][0] - m[1][1] + m[2][2], 1 + m[0][0] + m[1][1] + m[2][2]};
  const auto largest = std::ranges::max_element(squares) - squares.begin();
  const double twice = std::sqrt(squares[static_cast<std::size_t>(largest)]), k = 0.5 / twice;
  switch (largest) {
    case 0:
      return normalized(
          Rotation::from_xyzw(0.5 * twice, k * (m[0][1] + m[1][0]), k * (m[0][2] + m[2][0]), k * (m[2][1] - m[1][2])));
    case 1:
      return normalized(
          Rotation::from_xyzw(k * (m[0][1] + m[1][0]), 0.5 * twice, k * (m[1][2] + m[2][1]), k * (m[0][2] - m[2][0])));
    case 2:
      return normalized(
          Rotation::from_xyzw(k * (m[0][2] + m[2][0]), k * (m[1][2] + m[2][1]), 0.5 * twice, k * (m[1][0] - m[0][1])));
    default:
      return normalized(
          Rotation::from_xyzw(k * (m[2][1] - m[1][2]), k * (m[0][2] - m[2][0]), k * (m[1][0] - m[0][1]), 0.5 * twice));
  }
}

bool is_finite(const Affine& map) {
  return std::ranges::all_of(map.linear,
                             [](const auto& row) {
                               return ringdown::is_finite(Vec3{row[0], row[1], row[2]});
                             }) &&
         ringdown::is_finite(map.shift_m);
}

// Returns the roots of the scene that is played; of a file without scenes, all roots.
Result<std::vector<std::size_t>> roots_of(const JsonPlace& root, const std::vector<GltfNode>& nodes) {
  std::vector<std::size_t> found;
  const JsonPlace scenes = root["scenes"];
  if (scenes.size() == 0) {
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (!nodes[k].parent) found.push_back(k);
    }
    return found;
  }
  const Result<std::size_t> number = root["scene"].present() ? root["scene"].index() : 0;
  if (!number || *number >= scenes.size()) return root["scene"].wrong("the number of an element of scenes");
  const JsonPlace listed = scenes[*number]["nodes"];
  for (std::size_t k = 0; k < listed.size(); ++k) {
    const auto node = listed[k].index();
    if (!node || *node >= nodes.size() || nodes[*node].parent)
      return listed[k].wrong("a node of the file without a parent");
    found.push_back(*node);
  }
  return found;
}

// Returns which joint of its skin all points of a mesh follow; nothing if they follow several.
std::optional<std::size_t> only_bone(const modal::Glb& glb, const JsonPlace& mesh, const JsonPlace& skin) {
  constexpr double kWeight = 0.01;  // smaller ones are the rounding of a program that has blurred them
  if (skin["joints"].size() == 1) return 0;
  std::optional<std::size_t> only;
  for (std::size_t k = 0; k < mesh["primitives"].size(); ++k) {
    const JsonPlace attributes = mesh["primitives"][k]["attributes"];
    const auto joints = modal::read_numbers(glb, attributes["JOINTS_0"], 4, kMaxSkinPoints);
    const auto weights = modal::read_numbers(glb, attributes["WEIGHTS_0"], 4, kMaxSkinPoints);
    if (!joints || !weights || joints->size() != weights->size()) return {};
    for (std::size_t c = 0; c < joints->size(); ++c) {
      if (!((*weights)[c] > kWeight)) continue;
      const auto joint = static_cast<std::size_t>((*joints)[c]);
      if (only.value_or(joint) != joint) return {};
      only = joint;
    }
  }
  return only;
}

}  // namespace

Affine operator*(const Affine& outer, const Affine& inner) {
  return {product(outer.linear, inner.linear), outer * inner.shift_m};
}

Vec3 operator*(const Affine& map, Vec3 point_m) { return map.linear * point_m + map.shift_m; }

// In glTF y points up, in our axes z. Exact, because numbers only change their places and signs.
Affine upright(const Affine& map) {
  const Matrix3& m = map.linear;
  return {{{{m[0][0], m[0][1], m[0][2]}, {-m[2][0], -m[2][1], -m[2][2]}, {m[1][0], m[1][1], m[1][2]}}},
          {map.shift_m.x, -map.shift_m.z, map.shift_m.y}};
}

Affine to_affine(const Pose& pose) { return {to_matrix(pose.rotation), pose.position_m}; }

Affine inverse(const Pose& pose) {
  const Matrix3 back = transpose(to_matrix(pose.rotation));
  return {back, -1 * (back * pose.position_m)};
}

Parts parts_of(const Matrix3& linear) {
  Parts parts;
  const std::array columns{column(linear, 0), column(linear, 1), column(linear, 2)};
  parts.scale = {length(columns[0]), length(columns[1]), length(columns[2])};
  if (!(std::min({parts.scale.x, parts.scale.y, parts.scale.z}) > 0)) return parts;
  const Vec3 x = (1 / parts.scale.x) * columns[0], y = (1 / parts.scale.y) * columns[1];
  const Vec3 z = (1 / parts.scale.z) * columns[2];
  parts.sheared = std::max({std::abs(dot(x, y)), std::abs(dot(y, z)), std::abs(dot(z, x))}) > kMaxShear;
  parts.mirrored = dot(cross(x, y), z) < 0;
  const Vec3 across = y - dot(y, x) * x;
  const Vec3 upright_y = (1 / length(across)) * across;
  parts.rotation = to_rotation(from_columns(x, upright_y, cross(x, upright_y)));
  return parts;
}

void GltfNotes::add(const std::string& sentence) {
  if (sentences_.size() < kMaxNotes && known_.insert(sentence).second) sentences_.push_back(sentence);
}

Result<GltfDocument> GltfDocument::read(const modal::Glb& glb) {
  GltfDocument document(glb);
  const JsonPlace nodes = document.root()["nodes"];
  if (nodes.size() > kMaxNodes) return nodes.wrong(formatted("at most {} nodes", kMaxNodes));
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const std::string name = nodes[k]["name"].text_or("");
    document.nodes_.push_back(
        {.field = nodes[k], .name = name.empty() ? formatted("node{}", k) : name, .local = document.local_of(k)});
  }
  document.link_nodes();
  if (const auto good = document.result(); !good) return fail(good);
  document.place_nodes();
  if (const auto good = document.result(); !good) return fail(good);
  document.place_skins();
  if (const auto good = document.result(); !good) return fail(good);
  return document;
}

// A matrix, or a translation, a rotation and a scale.
Affine GltfDocument::local_of(std::size_t number_of_node) {
  const JsonPlace node = root()["nodes"][number_of_node];
  const JsonPlace matrix = node["matrix"];
  if (!matrix.present()) {
    return {scaled(to_matrix(rotation(node["rotation"])), vector(node["scale"], {1, 1, 1})),
            vector(node["translation"], {})};
  }
  if (matrix.size() != 16) {
    refuse(matrix.wrong("16 numbers"));
    return {};
  }
  std::array<double, 16> m{};
  for (std::size_t k = 0; k < 16; ++k) m[k] = number(matrix[k], 0);
  return {from_columns({m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}), {m[12], m[13], m[14]}};
}

void GltfDocument::link_nodes() {
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const JsonPlace children = nodes_[k].field["children"];
    for (std::size_t c = 0; c < children.size(); ++c) {
      const auto child = children[c].index();
      if (!child) return refuse(fail(child));
      if (*child >= nodes_.size() || *child == k || nodes_[*child].parent)
        return refuse(children[c].wrong("a node of the file that has no other parent"));
      nodes_[*child].parent = k;
      nodes_[k].children.push_back(*child);
    }
  }
}

// Goes from the roots down. A node within itself is below no root, so it is never reached.
void GltfDocument::place_nodes() {
  const std::size_t scenes = root()["scenes"].size();
  if (scenes > 1) notes.add(formatted("only one of the file's {} scenes is played", scenes));
  Result<std::vector<std::size_t>> found = roots_of(root(), nodes_);
  if (!found) return refuse(fail(found));
  std::vector<std::size_t> open = *std::move(found);
  for (const std::size_t top : open) nodes_[top].world = upright(nodes_[top].local);
  while (!open.empty()) {
    GltfNode& node = nodes_[open.back()];
    open.pop_back();
    if (node.in_scene) return refuse(node.field["children"].wrong("each node once"));
    node.in_scene = true;
    if (!is_finite(node.world)) return refuse(node.field.wrong("a node at a finite place"));
    for (const std::size_t child : node.children) {
      nodes_[child].world = node.world * nodes_[child].local;
      open.push_back(child);
    }
  }
}

// A skinned mesh lies in the frame that its bone makes of the bone's inverse bind matrix, wherever its own node is.
void GltfDocument::place_skins() {
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    GltfNode& node = nodes_[k];
    if (!node.in_scene || !node.field["skin"].present() || !node.field["mesh"].present() || !node.children.empty())
      continue;
    const JsonPlace skin = element(node.field["skin"], root()["skins"]);
    if (!skin.present()) return;
    const auto only = only_bone(*glb_, element(node.field["mesh"], root()["meshes"]), skin);
    const auto bone = only ? skin["joints"][*only].index() : Result<std::size_t>(nodes_.size());
    if (!bone || *bone >= nodes_.size() || *bone == k || !nodes_[*bone].in_scene) {
      notes.add("the mesh of " + quote(node.name) +
                " is bent by several bones, which is not followed; give each rigid part an object of its own");
      continue;
    }
    Affine bind;
    if (skin["inverseBindMatrices"].present()) {
      const auto matrices = modal::read_numbers(*glb_, skin["inverseBindMatrices"], 16, kMaxNodes);
      if (!matrices || matrices->size() < 16 * (*only + 1))
        return refuse(skin["inverseBindMatrices"].wrong("a matrix for each joint"));
      const double* m = matrices->data() + 16 * *only;
      bind = {from_columns({m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}), {m[12], m[13], m[14]}};
    }
    if (node.parent) std::erase(nodes_[*node.parent].children, k);
    node.parent = *bone;
    nodes_[*bone].children.push_back(k);
    node.local = bind;
    node.world = nodes_[*bone].world * bind;
    if (!is_finite(node.world)) return refuse(node.field.wrong("a node at a finite place"));
  }
}

double GltfDocument::number(const JsonPlace& field, double fallback) {
  const auto value = field.number_or(fallback);
  if (!value) refuse(fail(value));
  return value.value_or(fallback);
}

bool GltfDocument::flag(const JsonPlace& field, bool fallback) {
  if (!field.present()) return fallback;
  if (!field.json().is_boolean()) {
    refuse(field.wrong("true or false"));
    return fallback;
  }
  return field.json().get<bool>();
}

Vec3 GltfDocument::vector(const JsonPlace& field, Vec3 fallback) {
  if (!field.present()) return fallback;
  if (field.size() != 3) {
    refuse(field.wrong("3 numbers"));
    return fallback;
  }
  return {number(field[0], 0), number(field[1], 0), number(field[2], 0)};
}

Rotation GltfDocument::rotation(const JsonPlace& field) {
  if (!field.present()) return {};
  const Rotation turn = field.size() == 4 ? Rotation::from_xyzw(number(field[0], 0), number(field[1], 0),
                                                                number(field[2], 0), number(field[3], 1))
                                          : Rotation::from_xyzw(0, 0, 0, 0);
  if (std::abs(norm(turn) - 1) < 1e-3) return std::abs(norm(turn) - 1) < 1e-15 ? turn : normalized(turn);
  refuse(field.wrong("a unit quaternion"));
  return {};
}

std::vector<std::string> GltfDocument::texts(const JsonPlace& field) {
  std::vector<std::string> found;
  for (std::size_t k = 0; k < field.size(); ++k) {
    if (field[k].json().is_string()) {
      found.push_back(field[k].text_or(""));
    } else {
      refuse(field[k].wrong("a text"));
    }
  }
  return found;
}

JsonPlace GltfDocument::element(const JsonPlace& field, const JsonPlace& list) {
  if (!field.present()) return {nullptr, field.path()};
  const auto number = field.index();
  if (!number || *number >= list.size()) {
    refuse(field.wrong("the number of an element of " + list.path().substr(list.path().find(": ") + 2)));
    return {nullptr, field.path()};
  }
  return list[*number];
}

void GltfDocument::refuse(const tl::unexpected<Error>& error) {
  if (!error_) error_ = error.value();
}

Result<void> GltfDocument::result() const {
  if (error_) return tl::unexpected(*error_);
  return {};
}

}  // namespace ringdown::scene
