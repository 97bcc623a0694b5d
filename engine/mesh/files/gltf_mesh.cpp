#include "engine/mesh/files/gltf_mesh.h"

#include "engine/base/quote.h"
#include "engine/gltf/gltf_file.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

namespace ringdown::mesh {
namespace {

using modal::JsonPlace;

constexpr std::size_t kMaxJsonBytes = std::size_t{1} << 30;  // the text may have its buffers inside
constexpr std::size_t kMaxInfluences = 16;                   // sets of four joints at a point
constexpr std::size_t kList = 4, kStrip = 5, kFan = 6;       // a primitive's mode

// A file may require these: they say nothing about where triangles are, or are read.
bool is_read(const std::string& extension) {
  constexpr std::array kWhole = {"EXT_meshopt_compression", "KHR_mesh_quantization",    "KHR_audio_rigid_bodies",
                                 "KHR_implicit_shapes",     "KHR_physics_rigid_bodies", "KHR_animation_pointer",
                                 "KHR_lights_punctual",     "KHR_xmp_json_ld",          "EXT_lights_image_based"};
  constexpr std::array kFamilies = {"KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_"};
  return std::ranges::find(kWhole, extension) != kWhole.end() ||
         std::ranges::any_of(kFamilies, [&](const char* family) { return extension.starts_with(family); });
}

struct GltfNode {
  JsonPlace field;
  Eigen::Affine3d local, world;
  std::vector<std::size_t> children;
  bool has_parent = false, placed = false, seen = false;
};

// The points of a mesh before their node's place: with morph targets, and for a skin.
struct MeshPoints {
  std::vector<double> at;          // 3 numbers for each
  std::vector<double> shares;      // of a skin: `influences` numbers for each point, which add up to 1 ...
  std::vector<std::size_t> joint;  // ... and the joint of each
  std::size_t influences = 0;

  [[nodiscard]] std::size_t count() const { return at.size() / 3; }
  [[nodiscard]] Eigen::Vector3d point(std::size_t n) const { return Eigen::Map<const Eigen::Vector3d>(&at[3 * n]); }
};

class GltfMeshReader {
 public:
  GltfMeshReader(const modal::Glb& glb, std::size_t max_triangles) : glb_(glb), max_triangles_(max_triangles) {}

  Result<TriangleSoup> read() {
    if (auto good = check_extensions(); !good) return fail(good);
    if (auto good = read_nodes(); !good) return fail(good);
    place_nodes();
    std::vector<std::size_t> open = roots();
    while (!open.empty()) {
      const std::size_t number = open.back();
      open.pop_back();
      GltfNode& node = nodes_[number];
      if (!node.placed || node.seen) return node.field["children"].wrong("each node once");
      node.seen = true;
      if (auto added = add_meshes_of(node); !added) return fail(added);
      open.insert(open.end(), node.children.begin(), node.children.end());
    }
    for (std::size_t k = 0; nodes_.empty() && k < meshes().size(); ++k) {
      if (auto added = add_mesh(meshes()[k], JsonPlace(nullptr, ""), {}, Eigen::Affine3d::Identity()); !added)
        return fail(added);
    }
    return std::move(soup_);
  }

 private:
  using Matrices = std::vector<Eigen::Affine3d>;

  [[nodiscard]] JsonPlace root() const { return glb_.root(); }
  [[nodiscard]] JsonPlace meshes() const { return root()["meshes"]; }
  [[nodiscard]] std::size_t max_points() const { return 3 * max_triangles_; }

  [[nodiscard]] Result<void> check_extensions() const {
    const JsonPlace required = root()["extensionsRequired"];
    for (std::size_t k = 0; k < required.size(); ++k) {
      const std::string name = required[k].text_or("");
      if (is_read(name)) continue;
      return fail(ErrorKind::bad_input, "{} requires the extension {}, which is not supported; export it without",
                  glb_.name, quote(name));
    }
    return {};
  }

  static Result<Eigen::Affine3d> local_of(const JsonPlace& node) {
    std::array<double, 16> matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    std::array<double, 3> shift{0, 0, 0}, scale{1, 1, 1};
    std::array<double, 4> turn{0, 0, 0, 1};
    if (auto read = node["matrix"].numbers(matrix); !read) return fail(read);
    if (auto read = node["translation"].numbers(shift); !read) return fail(read);
    if (auto read = node["scale"].numbers(scale); !read) return fail(read);
    if (auto read = node["rotation"].numbers(turn); !read) return fail(read);
    if (node["matrix"].present()) return Eigen::Affine3d(Eigen::Map<const Eigen::Matrix4d>(matrix.data()));
    const Eigen::Quaterniond rotation(turn[3], turn[0], turn[1], turn[2]);
    if (!(std::abs(rotation.norm() - 1) < 1e-2)) return node["rotation"].wrong("a unit quaternion");
    return Eigen::Translation3d(shift[0], shift[1], shift[2]) * rotation.normalized() *
           Eigen::Scaling(scale[0], scale[1], scale[2]);
  }

  Result<void> read_nodes() {
    const JsonPlace nodes = root()["nodes"];
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const auto local = local_of(nodes[k]);
      if (!local) return fail(local);
      nodes_.push_back({.field = nodes[k], .local = *local, .world = *local, .children = {}});
    }
    for (GltfNode& node : nodes_) {
      const JsonPlace children = node.field["children"];
      for (std::size_t c = 0; c < children.size(); ++c) {
        const auto child = children[c].index();
        if (!child || *child >= nodes_.size() || nodes_[*child].has_parent)
          return children[c].wrong("a node of the file that has no other parent");
        nodes_[*child].has_parent = true;
        node.children.push_back(*child);
      }
    }
    return {};
  }

  [[nodiscard]] std::vector<std::size_t> nodes_without_parent() const {
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      if (!nodes_[k].has_parent) found.push_back(k);
    }
    return found;
  }

  // Goes down from all roots, because joints may be outside of the scene. A node within itself is never placed.
  void place_nodes() {
    std::vector<std::size_t> open = nodes_without_parent();
    while (!open.empty()) {
      GltfNode& node = nodes_[open.back()];
      open.pop_back();
      node.placed = true;
      for (const std::size_t child : node.children) {
        nodes_[child].world = node.world * nodes_[child].local;
        open.push_back(child);
      }
    }
  }

  std::vector<std::size_t> roots() {
    const JsonPlace scenes = root()["scenes"];
    if (scenes.size() == 0) return nodes_without_parent();
    const std::size_t number = root()["scene"].index_or(0).value_or(0);
    if (scenes.size() > 1) {
      soup_.notes.push_back(formatted("one of the file's {} scenes was read, number {}", scenes.size(), number));
    }
    const JsonPlace listed = scenes[number]["nodes"];
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < listed.size(); ++k) {
      const auto node = listed[k].index();
      if (node && *node < nodes_.size()) found.push_back(*node);
    }
    return found;
  }

  Result<void> add_meshes_of(const GltfNode& node) {
    if (node.field["extensions"]["EXT_mesh_gpu_instancing"].present())
      soup_.notes.push_back(
          "a node has instances by EXT_mesh_gpu_instancing, which is not supported: its mesh is read once");
    if (!node.field["mesh"].present()) return {};
    const auto number = node.field["mesh"].index();
    if (!number || *number >= meshes().size()) return node.field["mesh"].wrong("the number of a mesh of the file");
    Matrices joints;
    if (node.field["skin"].present()) {
      auto read = joints_of(node.field["skin"]);
      if (!read) return fail(read);
      joints = std::move(*read);
    }
    return add_mesh(meshes()[*number], node.field["weights"], joints, node.world);
  }

  // Returns true if a joint turns and moves bodies without scaling them.
  static bool keeps_lengths(const Eigen::Affine3d& joint) {
    constexpr double kRounding = 1e-4;  // of exporters that write seven digits
    return (joint.linear().transpose() * joint.linear() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <
           kRounding;
  }

  // Returns for each joint the map that it applies to a point of the mesh: the inverse bind matrix takes the point into
  // the joint's frame, and the joint's place takes it from there into the scene.
  [[nodiscard]] Result<Matrices> joints_of(const JsonPlace& reference) const {
    const auto number = reference.index();
    const JsonPlace skin = root()["skins"][number.value_or(root()["skins"].size())];
    if (!number || !skin.present()) return reference.wrong("the number of a skin of the file");
    const JsonPlace list = skin["joints"];
    if (list.size() == 0) return list.wrong("at least one joint");
    Matrices joints;
    for (std::size_t j = 0; j < list.size(); ++j) {
      const auto node = list[j].index();
      if (!node || *node >= nodes_.size() || !nodes_[*node].placed) return list[j].wrong("a node of the file");
      joints.push_back(nodes_[*node].world);
    }
    if (!skin["inverseBindMatrices"].present()) {
      if (!std::ranges::all_of(joints, keeps_lengths)) {
        return skin["inverseBindMatrices"].wrong(
            "given, because a joint of the skin is scaled: without them the size of the body is unknown; apply the "
            "armature's scale before the export");
      }
      return joints;
    }
    const auto matrices = modal::read_numbers(glb_, skin["inverseBindMatrices"], 16, max_points());
    if (!matrices) return fail(matrices);
    if (matrices->size() < 16 * joints.size()) return skin["inverseBindMatrices"].wrong("a matrix for each joint");
    for (std::size_t j = 0; j < joints.size(); ++j)
      joints[j] = joints[j] * Eigen::Affine3d(Eigen::Map<const Eigen::Matrix4d>(&(*matrices)[16 * j]));
    return joints;
  }

  Result<void> add_mesh(const JsonPlace& mesh, const JsonPlace& node_weights, const Matrices& joints,
                        const Eigen::Affine3d& place) {
    const JsonPlace primitives = mesh["primitives"];
    const JsonPlace weights = node_weights.present() ? node_weights : mesh["weights"];
    for (std::size_t k = 0; k < primitives.size(); ++k) {
      if (auto added = add_primitive(primitives[k], weights, joints, place); !added) return added;
    }
    return {};
  }

  Result<void> add_primitive(const JsonPlace& primitive, const JsonPlace& weights, const Matrices& joints,
                             const Eigen::Affine3d& place) {
    const auto mode = primitive["mode"].index_or(kList);
    if (!mode) return fail(mode);
    if (*mode < kList || !primitive["attributes"]["POSITION"].present()) return {};
    if (*mode > kFan) return primitive["mode"].wrong("a number from 0 to 6");
    auto points = points_of(primitive, weights);
    if (!points) return fail(points);
    if (!joints.empty()) {
      if (auto read = read_influences(primitive["attributes"], joints.size(), *points); !read) return read;
    }
    std::vector<std::uint32_t> corners(points->count());
    for (std::size_t k = 0; k < corners.size(); ++k) corners[k] = static_cast<std::uint32_t>(k);
    if (primitive["indices"].present()) {
      auto read = modal::read_indices(glb_, primitive["indices"], max_points());
      if (!read) return fail(read);
      corners = std::move(*read);
      if (std::ranges::any_of(corners, [&](std::uint32_t corner) { return corner >= points->count(); }))
        return primitive["indices"].wrong(formatted("numbers of the primitive's {} points", points->count()));
    }
    const std::size_t triangles =
        *mode == kList ? corners.size() / 3 : corners.size() - std::min<std::size_t>(corners.size(), 2);
    if (soup_.points.size() + points->count() > max_points() || soup_.triangles.size() + triangles > max_triangles_) {
      return fail(ErrorKind::too_large, "{} has more than {} triangles; simplify it in a mesh tool first", glb_.name,
                  max_triangles_);
    }
    add_triangles(put(*points, joints, place), corners, *mode, triangles);
    return {};
  }

  // Positions, moved by the morph targets that have a weight.
  Result<MeshPoints> points_of(const JsonPlace& primitive, const JsonPlace& weights) const {
    auto positions = modal::read_numbers(glb_, primitive["attributes"]["POSITION"], 3, max_points());
    if (!positions) return fail(positions);
    MeshPoints points;
    points.at = std::move(*positions);
    const JsonPlace targets = primitive["targets"];
    for (std::size_t t = 0; t < std::min(targets.size(), weights.size()); ++t) {
      const auto weight = weights[t].number();
      if (!weight) return fail(weight);
      if (*weight == 0 || !targets[t]["POSITION"].present()) continue;
      const auto shifts = modal::read_numbers(glb_, targets[t]["POSITION"], 3, max_points());
      if (!shifts) return fail(shifts);
      if (shifts->size() != points.at.size()) return targets[t]["POSITION"].wrong("a shift for each point");
      for (std::size_t k = 0; k < points.at.size(); ++k) points.at[k] += *weight * (*shifts)[k];
    }
    return points;
  }

  // Joints and their shares, which files round, so that they are made to add up to 1. A point without any share goes
  // with its first joint.
  Result<void> read_influences(const JsonPlace& attributes, std::size_t joint_count, MeshPoints& points) const {
    const std::size_t count = points.count();
    for (std::size_t set = 0; set < kMaxInfluences; ++set) {
      const JsonPlace joints = attributes[formatted("JOINTS_{}", set)];
      const JsonPlace weights = attributes[formatted("WEIGHTS_{}", set)];
      if (!joints.present() || !weights.present()) {
        if (set == 0) return joints.wrong("given, with weights: the mesh has a skin");
        break;
      }
      const auto numbers = modal::read_numbers(glb_, joints, 4, max_points());
      const auto shares = modal::read_numbers(glb_, weights, 4, max_points());
      for (const auto* read : {&numbers, &shares}) {
        if (!*read) return fail(read->error());
        if ((*read)->size() != 4 * count) return joints.wrong("four joints and weights for each point");
      }
      points.shares.insert(points.shares.end(), shares->begin(), shares->end());
      for (const double joint : *numbers) {
        if (!(joint >= 0 && joint < static_cast<double>(joint_count)))
          return joints.wrong("numbers of the skin's joints");
        points.joint.push_back(static_cast<std::size_t>(joint));
      }
      ++points.influences;
    }
    return {};
  }

  // The linear map that places a point: that of the node, or of the joints together.
  static Eigen::Affine3d map_of(const MeshPoints& points, std::size_t n, const Matrices& joints,
                                const Eigen::Affine3d& place) {
    if (joints.empty()) return place;
    Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
    double total = 0;
    for (std::size_t set = 0; set < points.influences; ++set) {
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t at = 4 * (set * points.count() + n) + k;
        sum += points.shares[at] * joints[points.joint[at]].matrix();
        total += points.shares[at];
      }
    }
    if (!(total > 0)) return joints[points.joint[4 * n]];
    return Eigen::Affine3d(Eigen::Matrix4d(sum / total));
  }

  struct Put {
    std::size_t first = 0;       // of the points in the soup
    std::vector<bool> mirrored;  // whether the map of a point is a mirror
  };

  Put put(const MeshPoints& points, const Matrices& joints, const Eigen::Affine3d& place) {
    Put done{.first = soup_.points.size(), .mirrored = {}};
    double farthest = 0, stretch = 0;
    for (std::size_t n = 0; n < points.count(); ++n) {
      const Eigen::Affine3d map = map_of(points, n, joints, place);
      soup_.points.emplace_back((map * points.point(n)).transpose());
      done.mirrored.push_back(map.linear().determinant() < 0);
      farthest = std::max(farthest, points.point(n).cwiseAbs().maxCoeff());
      stretch = std::max(stretch, map.linear().norm());
    }
    soup_.rounding = std::max(soup_.rounding, stretch * float_spacing(farthest));
    return done;
  }

  // Every second triangle of a strip runs the other way about (glTF 2.0, section 3.7.2.1).
  void add_triangles(const Put& put, const std::vector<std::uint32_t>& corners, std::size_t mode, std::size_t count) {
    for (std::size_t t = 0; t < count; ++t) {
      std::array<std::size_t, 3> at{};
      if (mode == kList) at = {3 * t, 3 * t + 1, 3 * t + 2};
      if (mode == kStrip) at = {t, t + 1 + t % 2, t + 2 - t % 2};
      if (mode == kFan) at = {t + 1, t + 2, 0};
      std::array<std::int32_t, 3> triangle{};
      for (std::size_t i = 0; i < 3; ++i) triangle[i] = static_cast<std::int32_t>(put.first + corners[at[i]]);
      if (put.mirrored[corners[at[0]]]) std::swap(triangle[1], triangle[2]);
      soup_.triangles.push_back(triangle);
    }
  }

  const modal::Glb& glb_;
  std::size_t max_triangles_;
  std::vector<GltfNode> nodes_;
  TriangleSoup soup_;
};

// The length that the header of a .glb says, where the file is longer: some programs leave bytes behind it.
std::string_view without_tail(std::string_view content) {
  std::uint32_t length = 0;
  if (!content.starts_with("glTF") || content.size() < 12) return content;
  std::memcpy(&length, content.data() + 8, sizeof length);
  return content.substr(0, length);
}

}  // namespace

Result<TriangleSoup> read_gltf_mesh(std::string_view content, const std::filesystem::path& path,
                                    std::size_t max_triangles) {
  const auto glb = modal::parse_gltf(std::as_bytes(std::span(without_tail(content))), path.string(),
                                     modal::files_beside(path), kMaxJsonBytes);
  if (!glb) return fail(glb);
  return GltfMeshReader(*glb, max_triangles).read();
}

}  // namespace ringdown::mesh
