#include "engine/scene/gltf/picture_writer.h"

#include "engine/base/quote.h"
#include "engine/base/version.h"
#include "engine/scene/gltf/file_axes.h"
#include "engine/scene/gltf/keyframes.h"
#include "engine/scene/gltf/shapes.h"
#include "engine/scene/motion_path.h"
#include "engine/scene/rotation.h"
#include "engine/scene/solid.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>

namespace ringdown::scene {
namespace {

using modal::Json;

constexpr double kSlab = 0.05;  // thickness of the slab of a plane, of its edges

class PictureScene {
 public:
  PictureScene(const SceneDescription& scene, std::span<const modal::Bank> banks) : scene_(scene), banks_(banks) {}

  Result<std::vector<std::byte>> write() {
    for (const StaticDescription& item : scene_.statics) add(item);
    for (const BodyDescription& body : scene_.bodies) {
      if (const auto added = add(body); !added) return fail(added);
    }
    Json document = {{"asset", {{"version", "2.0"}, {"generator", std::string("Ringdown ") + kVersion}}}, {"scene", 0}};
    if (scene_.camera) {
      document["cameras"] = Json::array({camera_of(*scene_.camera)});
      nodes_.push_back(camera_node_of(*scene_.camera));
    }
    Json all = Json::array();
    for (std::size_t k = 0; k < nodes_.size(); ++k) all.push_back(k);
    document["scenes"] = Json::array({{{"nodes", all}}});
    document["nodes"] = nodes_;
    document["meshes"] = meshes_;
    if (!materials_.empty()) document["materials"] = materials_;
    if (const Json animations = keyframes_.finished(); !animations.empty()) document["animations"] = animations;
    return std::move(writer_).finish(std::move(document));
  }

 private:
  // Half the edge of a plane's slab: twice as far as any body goes from the origin.
  [[nodiscard]] double reach_m() const {
    double farthest = 1;
    for (const BodyDescription& body : scene_.bodies) {
      farthest = std::max(farthest, length(body.position_m));
      if (!body.path) continue;
      for (const Pose& pose : body.path->poses) farthest = std::max(farthest, length(pose.position_m));
    }
    return 2 * farthest;
  }

  void add(const StaticDescription& item) {
    const bool plane = item.type == StaticType::plane;
    const double edge_m = 2 * reach_m();
    const Vec3 size = plane ? Vec3{edge_m, edge_m, kSlab * edge_m} : item.size_m;
    const Vec3 normal = plane ? (1 / length(item.normal)) * item.normal : Vec3{0, 0, 1};
    const Pose pose = plane ? Pose{(item.offset_m - 0.5 * size.z) * normal, turn_between({0, 0, 1}, normal)}
                            : Pose{item.position_m, normalized(item.rotation)};
    const Shape box{.type = ShapeType::box, .size_m = size};
    add_node(item.name, add_mesh(mesh_of(box), {}), pose);
  }

  Result<void> add(const BodyDescription& body) {
    const auto object = std::ranges::find(scene_.objects, body.object, &ObjectDescription::name);
    const auto number = static_cast<std::size_t>(object - scene_.objects.begin());
    const bool sounds = object != scene_.objects.end();
    const modal::Bank* bank = sounds ? &banks_[number] : nullptr;
    const modal::MaterialScale scale = sounds ? object->material : modal::MaterialScale{};
    std::string material;
    if (bank) material = bank->material && !bank->material->name.empty() ? bank->material->name : bank->name;
    std::size_t mesh = 0;
    if (bank && !bank->triangles.empty()) {
      const auto [known, is_new] = mesh_of_bank_.try_emplace({object->bank.string(), scale.size}, meshes_.size());
      if (is_new) {
        ShapeMesh surface{.triangles = bank->triangles};
        for (const auto& p : bank->positions) surface.points_m.push_back(scale.size * Vec3{p[0], p[1], p[2]});
        add_mesh(surface, material);
      }
      mesh = known->second;
    } else {
      const auto solid = make_solid(body, bank, scale);
      if (!solid) return fail(solid.error().kind, "body " + quote(body.name) + ": " + solid.error().message);
      mesh = add_mesh(mesh_of_solid(*solid), material);
    }
    const std::size_t node = add_node(body.name, mesh, {body.position_m, normalized(body.rotation)});
    if (body.path && !body.path->poses.empty()) keyframes_.add(node, *body.path, body.start_s);
    return {};
  }

  // The surface of a collider in the object's frame.
  static ShapeMesh mesh_of_solid(const Solid& solid) {
    const CollisionShape& from = solid.shape;
    Shape shape{.type = from.type, .size_m = from.size_m, .radius_m = from.radius_m};
    shape.center_m = from.center_m + solid.mass.center_m;
    if (from.type == ShapeType::convex || from.type == ShapeType::trimesh) {
      ShapeMesh mesh{.points_m = from.points, .triangles = from.triangles};
      for (Vec3& p : mesh.points_m) p = p + solid.mass.center_m;
      shape.mesh = std::make_shared<const ShapeMesh>(std::move(mesh));
    }
    return mesh_of(shape);
  }

  std::size_t add_mesh(const ShapeMesh& mesh, const std::string& material) {
    std::vector<float> points;
    std::vector<std::uint32_t> corners;
    for (const Vec3& p : mesh.points_m)
      for (const double x : {p.x, p.y, p.z}) points.push_back(static_cast<float>(x));
    for (const auto& triangle : mesh.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
    Json primitive = {{"attributes", {{"POSITION", writer_.add_floats(points, 3, modal::GlbWriter::Use::vertices)}}},
                      {"indices", writer_.add_indices(corners)}};
    if (!material.empty()) {
      const auto [known, is_new] = material_of_.try_emplace(material, materials_.size());
      if (is_new) materials_.push_back({{"name", material}});
      primitive["material"] = known->second;
    }
    meshes_.push_back({{"primitives", Json::array({std::move(primitive)})}});
    return meshes_.size() - 1;
  }

  std::size_t add_node(const std::string& name, std::size_t mesh, const Pose& pose) {
    nodes_.push_back({{"name", name},
                      {"mesh", mesh},
                      {"translation", json_of(to_file(pose.position_m))},
                      {"rotation", json_of(to_file(pose.rotation))}});
    return nodes_.size() - 1;
  }

  const SceneDescription& scene_;
  std::span<const modal::Bank> banks_;
  modal::GlbWriter writer_;
  KeyframeWriter keyframes_{writer_};
  std::map<std::pair<std::string, double>, std::size_t> mesh_of_bank_;  // by bank and size
  std::map<std::string, std::size_t> material_of_;
  Json nodes_ = Json::array(), meshes_ = Json::array(), materials_ = Json::array();
};

}  // namespace

Result<std::vector<std::byte>> to_picture_glb(const SceneDescription& scene, std::span<const modal::Bank> banks) {
  return PictureScene(scene, banks).write();
}

}  // namespace ringdown::scene
