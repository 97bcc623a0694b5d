#include "engine/scene/gltf/writer.h"

#include "engine/base/quote.h"
#include "engine/base/version.h"
#include "engine/modal/bank_model.h"
#include "engine/modal/scaled_bank.h"
#include "engine/scene/fixed_contacts.h"
#include "engine/scene/gltf/document.h"
#include "engine/scene/gltf/file_axes.h"
#include "engine/scene/gltf/keyframes.h"
#include "engine/scene/gltf/scene.h"
#include "engine/scene/gltf/shapes.h"
#include "engine/scene/rotation.h"
#include "engine/scene/scene_text.h"
#include "engine/scene/solid.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <numbers>
#include <string>
#include <utility>

namespace ringdown::scene {
namespace {

using modal::Json;

class GlbScene {
 public:
  GlbScene(const SceneDescription& scene, std::span<const modal::Bank> banks) : scene_(scene), banks_(banks) {}

  Result<std::vector<std::byte>> write() {
    add_models();
    for (const StaticDescription& item : scene_.statics) add(item);
    for (const BodyDescription& body : scene_.bodies) {
      if (const auto added = add(body); !added) return fail(added);
    }
    for (const EmitterDescription& emitter : scene_.emitters) {
      if (const auto added = add(emitter.body); !added) return fail(added);
    }
    for (const JointDescription& joint : scene_.joints) add(joint);
    if (scene_.camera) add(*scene_.camera);
    Json document = finished();
    if (!keyframes_.finished().empty()) {
      // In these steps the contacts between the frames can be simulated as they were.
      document["extras"]["ringdown"]["step_s"] = scene_.step_s;
      return std::move(writer_).finish(std::move(document));
    }
    const auto seen = parse_gltf_scene(modal::GlbWriter(writer_).finish(document), "scene.glb", {});
    if (!seen) return fail(seen);
    SceneDescription own = scene_;
    for (std::size_t k = 0; k < own.objects.size(); ++k) {
      own.objects[k].bank = formatted("#{}", model_of_[k]);
      own.objects[k].gain *= banks_[k].gain;
    }
    document["extras"]["ringdown"] = {{"scene", to_toml(own)}, {"fingerprint", fingerprint(seen->scene)}};
    return std::move(writer_).finish(std::move(document));
  }

 private:
  // Objects with the same bank share its model. An object in another size or material also gets its own model, for
  // other programs, which have no such scale.
  void add_models() {
    std::map<std::pair<std::string, std::string>, std::size_t> known;
    const auto model_at = [&](std::size_t k, const modal::MaterialScale& scale) {
      const std::string key =
          Json{scale.alpha, scale.beta, scale.density, scale.stiffness, scale.size, scale.heat, scale.air}.dump();
      const auto [model, is_new] = known.try_emplace({scene_.objects[k].bank.string(), key}, models_.size());
      if (!is_new) return model->second;
      const modal::Bank played = scale == modal::MaterialScale{} ? banks_[k] : modal::scaled(banks_[k], scale);
      add_model(played.mode_count() > 0 ? played : banks_[k]);
      return model->second;
    };
    for (std::size_t k = 0; k < scene_.objects.size(); ++k) {
      model_of_.push_back(model_at(k, {}));
      played_model_of_.push_back(model_at(k, scene_.objects[k].material));
    }
  }

  void add_model(const modal::Bank& bank) {
    auto written = modal::add_model(writer_, bank, /*packed=*/false);
    if (written.material) {
      written.model["material"] = materials_.size();
      materials_.push_back(*std::move(written.material));
    }
    models_.push_back(std::move(written.model));
    meshes_.push_back({{"name", bank.name}, {"primitives", Json::array({std::move(written.primitive)})}});
  }

  std::size_t add_node(Json node, bool is_root = true) {
    nodes_.push_back(std::move(node));
    if (is_root) roots_.push_back(nodes_.size() - 1);
    return nodes_.size() - 1;
  }

  std::size_t add_shape(Json shape) {
    shapes_.push_back(std::move(shape));
    return shapes_.size() - 1;
  }

  // A mesh of a body's own, on a node that is in no scene.
  std::size_t add_mesh(const ShapeMesh& mesh) {
    std::vector<float> points;
    std::vector<std::uint32_t> corners;
    for (const Vec3& p : mesh.points_m)
      for (const double x : {p.x, p.y, p.z}) points.push_back(static_cast<float>(x));
    for (const auto& triangle : mesh.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
    const std::size_t positions = writer_.add_floats(points, 3, modal::GlbWriter::Use::vertices);
    Json primitive = {{"attributes", {{"POSITION", positions}}}};
    if (!corners.empty()) primitive["indices"] = writer_.add_indices(corners);
    meshes_.push_back({{"primitives", Json::array({std::move(primitive)})}});
    return add_node({{"mesh", meshes_.size() - 1}}, false);
  }

  // A geometric mean, which the extension does not have, is the product of roots.
  static void put_combined(Json& material, std::initializer_list<std::pair<const char*, double>> values,
                           const char* key, Combine way) {
    constexpr std::array kNames = {"average", "minimum", "maximum", "multiply", "multiply"};
    for (const auto& [name, value] : values) material[name] = way == Combine::geometric_mean ? std::sqrt(value) : value;
    material[key] = kNames[static_cast<std::size_t>(way)];
  }

  Json collider(Json geometry, const FrictionSurface& surface, const CollisionFilter& filter) {
    Json material;
    put_combined(material,
                 {{"staticFriction", surface.friction},
                  {"dynamicFriction", surface.sliding_friction.value_or(surface.friction)}},
                 "frictionCombine", surface.friction_combine);
    put_combined(material, {{"restitution", surface.restitution}}, "restitutionCombine", surface.restitution_combine);
    material["extras"]["ringdown"]["rolling_m"] = surface.rolling_m;
    physics_materials_.push_back(std::move(material));
    Json made = {{"geometry", std::move(geometry)}, {"physicsMaterial", physics_materials_.size() - 1}};
    if (filter == CollisionFilter{}) return made;
    Json written = Json::object();
    if (!filter.systems.empty()) written["collisionSystems"] = filter.systems;
    if (!filter.only_with.empty()) written["collideWithSystems"] = filter.only_with;
    if (!filter.not_with.empty()) written["notCollideWithSystems"] = filter.not_with;
    filters_.push_back(std::move(written));
    made["collisionFilter"] = filters_.size() - 1;
    return made;
  }

  std::size_t add_finish(const FrictionSurface& surface) {
    constexpr double kWavinessLength_m = 2e-3;  // any will do: what is felt is the quotient
    Json finish = {{"roughness", surface.texture.roughness_m},
                   {"correlationLength", surface.texture.correlation_m},
                   {"spectralSlope", surface.texture.spectral_slope}};
    if (surface.texture.shortest_m > 0) finish["shortWavelength"] = surface.texture.shortest_m;
    if (surface.waviness) {
      finish["waviness"] = *surface.waviness * kWavinessLength_m;
      finish["wavinessLength"] = kWavinessLength_m;
    }
    finishes_.push_back(std::move(finish));
    return finishes_.size() - 1;
  }

  void add(const StaticDescription& item) {
    Json node = {{"name", item.name}};
    Json shape = {{"type", "plane"}, {"plane", Json::object()}};
    if (item.type == StaticType::plane) {
      const Vec3 normal = (1 / length(item.normal)) * item.normal;
      node["translation"] = json_of(to_file(item.offset_m * normal));
      node["rotation"] = json_of(normalized(turn_between({0, 1, 0}, to_file(normal))));
    } else {
      node["translation"] = json_of(to_file(item.position_m));
      node["rotation"] = json_of(to_file(normalized(item.rotation)));
      shape = {{"type", "box"}, {"box", {{"size", json_of(item.size_m)}}}};
    }
    node["extensions"][kPhysicsExtension]["collider"] =
        collider({{"shape", add_shape(std::move(shape))}}, item.surface, item.filter);
    node["extensions"][kAudioExtension]["acousticSurface"] = add_finish(item.surface);
    add_node(std::move(node));
  }

  Result<void> add(const BodyDescription& body) {
    const auto object = std::ranges::find(scene_.objects, body.object, &ObjectDescription::name);
    const bool sounds = object != scene_.objects.end();
    const auto number = static_cast<std::size_t>(object - scene_.objects.begin());
    const modal::MaterialScale scaled = sounds ? object->material : modal::MaterialScale{};
    const auto solid = make_solid(body, sounds ? &banks_[number] : nullptr, scaled);
    if (!solid) return fail("body " + quote(body.name), solid);
    Json node = {{"name", body.name},
                 {"translation", json_of(to_file(body.position_m))},
                 {"rotation", json_of(to_file(normalized(body.rotation)))}};
    if (body.two_way) node["extras"]["ringdown"]["contact"] = "two-way";
    Json& physics = node["extensions"][kPhysicsExtension] = Json::object();
    if (sounds) {
      node["mesh"] = played_model_of_[number];
      node["extensions"][kAudioExtension] = {{"modalModel", played_model_of_[number]},
                                             {"gain", object->gain * banks_[number].gain},
                                             {"acousticSurface", add_finish(body.surface)}};
    }
    if (!body.fixed || body.path) physics["motion"] = motion(body, solid->mass);
    const CollisionShape& shape = solid->shape;
    const std::size_t self = nodes_.size();
    if (shape.type == ShapeType::box || shape.type == ShapeType::sphere) {
      const Json written = shape.type == ShapeType::box
                               ? Json{{"type", "box"}, {"box", {{"size", json_of(shape.size_m)}}}}
                               : Json{{"type", "sphere"}, {"sphere", {{"radius", shape.radius_m}}}};
      Json made = collider({{"shape", add_shape(written)}}, body.surface, body.filter);
      const Vec3 center = shape.center_m + solid->mass.center_m;
      if (length(center) == 0) {
        physics["collider"] = std::move(made);
      } else {
        node["children"] = Json::array({self + 1});
        add_node(std::move(node));
        add_node({{"name", body.name + " collider"},
                  {"translation", json_of(center)},
                  {"extensions", {{kPhysicsExtension, {{"collider", std::move(made)}}}}}},
                 false);
        place(body, self);
        return {};
      }
    } else {
      const std::size_t mesh_node = body.shape.mesh ? add_mesh(*body.shape.mesh) : self;
      physics["collider"] =
          collider({{"node", mesh_node}, {"convexHull", shape.type == ShapeType::convex}}, body.surface, body.filter);
    }
    place(body, add_node(std::move(node)));
    return {};
  }

  void place(const BodyDescription& body, std::size_t node) {
    body_nodes_[body.name] = node;
    if (body.path) keyframes_.add(node, *body.path, body.start_s);
  }

  static Json motion(const BodyDescription& body, const RigidMass& mass) {
    modal::MassProperties principal;
    set_inertia(principal, mass.inertia_kg_m2);
    const Rotation back = inverse(normalized(body.rotation));
    return {{"mass", mass.mass_kg},
            {"centerOfMass", json_of(mass.center_m)},
            {"inertiaDiagonal", json_of(principal.inertia_kg_m2)},
            {"inertiaOrientation", principal.orientation},
            {"linearVelocity", json_of(rotated(back, body.velocity_m_s))},
            {"angularVelocity", json_of(rotated(back, body.spin_rad_s))},
            {"gravityFactor", body.gravity_factor},
            {"isKinematic", body.path != nullptr}};
  }

  // A node at a place of the joint, in the file's axes, below the node of a body, or below none.
  std::size_t add_end(const std::string& body, const JointDescription& joint, const Pose& place) {
    const Rotation axes = place.rotation;
    const auto found = body_nodes_.find(body);
    if (found == body_nodes_.end())
      return add_node({{"name", joint.name}, {"translation", json_of(place.position_m)}, {"rotation", json_of(axes)}});
    const BodyDescription& described = *std::ranges::find(scene_.bodies, body, &BodyDescription::name);
    const Rotation back = inverse(to_file(normalized(described.rotation)));
    const Vec3 local = rotated(back, place.position_m - to_file(described.position_m));
    const std::size_t number = add_node(
        {{"name", joint.name}, {"translation", json_of(local)}, {"rotation", json_of(normalized(back * axes))}}, false);
    nodes_[found->second]["children"].push_back(number);
    return number;
  }

  static Json drive_of(const JointDrive& drive, bool turns, std::size_t axis) {
    return {{"type", turns ? "angular" : "linear"}, {"mode", "force"},          {"axis", axis},
            {"stiffness", drive.stiffness},         {"damping", drive.damping}, {"positionTarget", drive.target},
            {"velocityTarget", drive.speed},        {"maxForce", drive.max}};
  }

  // Connects the nodes of both ends.
  void add_joint(const JointDescription& joint, Json written, std::size_t held, std::size_t connected) {
    joints_.push_back(std::move(written));
    nodes_[held]["extensions"][kPhysicsExtension]["joint"] = {
        {"connectedNode", connected}, {"joint", joints_.size() - 1}, {"enableCollision", joint.collides}};
  }

  void add_free(const JointDescription& joint) {
    Json written = {{"limits", Json::array()}};
    for (const AxesLimit& limit : joint.limits) {
      Json own = {{limit.turns ? "angularAxes" : "linearAxes", limit.axes}};
      if (limit.low > range::kAxesLimit.low) own["min"] = limit.low;
      if (limit.high < range::kAxesLimit.high) own["max"] = limit.high;
      if (limit.stiffness > 0) own["stiffness"] = limit.stiffness;
      if (limit.stiffness > 0) own["damping"] = limit.damping;
      written["limits"].push_back(std::move(own));
    }
    for (const AxisDrive& drive : joint.drives)
      written["drives"].push_back(drive_of(drive.drive, drive.turns, drive.axis));
    const auto place = [](Vec3 position_m, const Rotation& turn) {
      return Pose{to_file(position_m), normalized(to_file(turn))};
    };
    const std::string &first = joint.frame_of_body ? joint.body : joint.other,
                      &second = joint.frame_of_body ? joint.other : joint.body;
    const std::size_t held = add_end(first, joint, place(joint.anchor_m, joint.rotation));
    const std::size_t connected = add_end(second, joint, place(joint.end.position_m, joint.end.rotation));
    add_joint(joint, std::move(written), held, connected);
  }

  // The frame's x axis is the joint's axis. The joint holds `other`, or the world, and connects the body.
  void add(const JointDescription& joint) {
    if (joint.type == JointType::free) return add_free(joint);
    const bool hinge = joint.type == JointType::hinge, slider = joint.type == JointType::slider;
    const Rotation axes = hinge || slider
                              ? normalized(turn_between({1, 0, 0}, to_file((1 / length(joint.axis)) * joint.axis)))
                              : Rotation{};
    const auto limit = [](const char* kind, std::vector<int> held) {
      return Json{{kind, held}, {"min", 0}, {"max", 0}};
    };
    Json limits = Json::array();
    limits.push_back(slider ? limit("linearAxes", {1, 2}) : limit("linearAxes", {0, 1, 2}));
    if (hinge) limits.push_back(limit("angularAxes", {1, 2}));
    if (slider || joint.type == JointType::fixed) limits.push_back(limit("angularAxes", {0, 1, 2}));
    Json range = {{slider ? "linearAxes" : "angularAxes", {0}}};
    const double radians = std::numbers::pi / 180;
    if (hinge && joint.low_degrees > range::kLimit_degrees.low) range["min"] = radians * joint.low_degrees;
    if (hinge && joint.high_degrees < range::kLimit_degrees.high) range["max"] = radians * joint.high_degrees;
    if (slider && joint.low_m > range::kPosition_m.low) range["min"] = joint.low_m;
    if (slider && joint.high_m < range::kPosition_m.high) range["max"] = joint.high_m;
    if (range.size() > 1 && joint.limit_stiffness > 0) {
      range["stiffness"] = joint.limit_stiffness;
      range["damping"] = joint.limit_damping;
    }
    if (range.size() > 1) limits.push_back(range);
    Json written = {{"limits", limits}};
    if (joint.drive) written["drives"] = Json::array({drive_of(*joint.drive, !slider, 0)});
    const Pose place{to_file(joint.anchor_m), axes};
    const std::size_t held = add_end(joint.other, joint, place), connected = add_end(joint.body, joint, place);
    add_joint(joint, std::move(written), held, connected);
  }

  void add(const CameraDescription& camera) {
    cameras_.push_back(camera_of(camera));
    add_node(camera_node_of(camera));
  }

  Json finished() {
    Json physics = Json::object(), audio = Json::object(), document;
    const auto put = [](Json& where, const char* key, const Json& list) {
      if (!list.empty()) where[key] = list;
    };
    put(physics, "physicsMaterials", physics_materials_);
    put(physics, "collisionFilters", filters_);
    put(physics, "physicsJoints", joints_);
    put(audio, "modalModels", models_);
    put(audio, "acousticMaterials", materials_);
    put(audio, "acousticSurfaces", finishes_);
    document = {{"asset", {{"version", "2.0"}, {"generator", std::string("Ringdown ") + kVersion}}},
                {"extensionsUsed", Json::array()},
                {"scene", 0},
                {"scenes", Json::array({Json::object()})}};
    put(document, "nodes", nodes_);
    put(document, "meshes", meshes_);
    put(document, "cameras", cameras_);
    put(document, "animations", keyframes_.finished());
    put(document["scenes"][0], "nodes", roots_);
    const auto use = [&document](const char* name, const Json& content) {
      if (content.empty()) return;
      document["extensionsUsed"].push_back(name);
      document["extensions"][name] = content;
    };
    use(kPhysicsExtension, physics);
    use(kAudioExtension, audio);
    if (!shapes_.empty()) use(kShapesExtension, {{"shapes", shapes_}});
    return document;
  }

  const SceneDescription& scene_;
  std::span<const modal::Bank> banks_;
  modal::GlbWriter writer_;
  KeyframeWriter keyframes_{writer_};
  std::vector<std::size_t> model_of_;              // of each object's bank
  std::vector<std::size_t> played_model_of_;       // of the bank in the object's material and size
  std::map<std::string, std::size_t> body_nodes_;  // by the body's name
  Json nodes_ = Json::array(), roots_ = Json::array(), meshes_ = Json::array(), cameras_ = Json::array();
  Json shapes_ = Json::array(), models_ = Json::array(), materials_ = Json::array(), finishes_ = Json::array();
  Json physics_materials_ = Json::array(), filters_ = Json::array(), joints_ = Json::array();
};

}  // namespace

Result<std::vector<std::byte>> to_glb(const SceneDescription& scene, std::span<const modal::Bank> banks) {
  SceneDescription whole = scene;
  for (BodyDescription& body : whole.bodies) body.breaks.reset();
  for (EmitterDescription& emitter : whole.emitters) emitter.body.breaks.reset();
  return GlbScene(whole, banks).write();
}

}  // namespace ringdown::scene
