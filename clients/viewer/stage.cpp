#include "clients/viewer/stage.h"

#include "clients/viewer/render/liquid_surface.h"
#include "clients/viewer/render/look.h"
#include "clients/viewer/shelves.h"
#include "engine/base/formatted.h"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <unordered_set>
#include <utility>

namespace ringdown::viewer {
namespace {

constexpr double kFlash_s = 0.5;
constexpr double kVibration_hz = 1.2;     // slow enough to follow by eye
constexpr float kVibrationShare = 0.07F;  // of the body's diagonal
constexpr glm::vec3 kLiquidColour{0.30F, 0.52F, 0.70F};
constexpr double kUsualDensity_kg_m3 = 2500;
constexpr float kNear_m = 3;      // bodies farther from the origin do not move the objects without a body
constexpr float kFarAway_m = 20;  // the light is not fitted to bodies farther away than this

glm::vec3 to_glm(Vec3 v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

glm::quat to_glm(const Quaternion& q) {
  return {static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)};
}

glm::mat4 to_glm(const Pose& pose) {
  return glm::translate(glm::mat4(1), to_glm(pose.position_m)) * glm::mat4_cast(to_glm(pose.rotation));
}

glm::vec3 colour_of(const KnownObject* object) {
  if (!object || !object->bank) return kSilentColour;
  const auto& material = object->bank->bank.material;
  return material_colour(material ? material->name : object->name);
}

double mass_of(const KnownObject* object, Vec3 size_m) {
  if (object && object->bank && object->bank->bank.mass) {
    return object->bank->bank.mass->mass_kg * object->scale.density * std::pow(object->scale.size, 3);
  }
  return kUsualDensity_kg_m3 * size_m.x * size_m.y * size_m.z;
}

// Strength of a flash on a logarithmic scale: ten times the impulse adds 0.2.
float strength_of(Vec3 impulse_ns) {
  return static_cast<float>(std::clamp(0.75 + 0.2 * std::log10(length(impulse_ns) + 1e-9), 0.15, 1.0));
}

}  // namespace

float glow_of(double peak, double age_s) {
  constexpr double kDark_db = 70, kFade_s = 0.3;
  if (peak <= 0) return 0;
  const double level = 1 + 20 * std::log10(peak) / kDark_db;
  return static_cast<float>(std::clamp(level, 0.0, 1.0) * std::clamp(1 - (age_s - kFade_s) / kFade_s, 0.0, 1.0));
}

const MeshStore::Mesh& MeshStore::of_bank(const std::shared_ptr<const KnownBank>& bank, SceneRenderer& renderer) {
  const auto found = banks_.find(bank.get());
  if (found != banks_.end()) return found->second.mesh;
  Mesh mesh{0, shaded_mesh(bank->bank)};
  mesh.id = renderer.add_mesh(mesh.shape);
  return banks_.emplace(bank.get(), OfBank{bank, std::move(mesh)}).first->second.mesh;
}

const MeshStore::Mesh& MeshStore::of_shape(const std::string& shape, Vec3 size_m, SceneRenderer& renderer) {
  const std::string key = formatted("{} {:f} {:f} {:f}", shape, size_m.x, size_m.y, size_m.z);
  const auto found = shapes_.find(key);
  if (found != shapes_.end()) return found->second;
  const bool round = shape == "sphere";
  Mesh mesh{0, round ? sphere_mesh(static_cast<float>(size_m.x / 2)) : box_mesh(to_glm(size_m))};
  mesh.id = renderer.add_mesh(mesh.shape);
  return shapes_.emplace(key, std::move(mesh)).first->second;
}

MeshId MeshStore::of_liquid(const KnownObject& object, double level_m, SceneRenderer& renderer) {
  OfLiquid& known = liquids_[object.name];
  if (known.bank.lock() == object.bank && known.level_m == level_m) return known.id;
  if (known.id != 0) renderer.remove_mesh(known.id);
  const auto surface = liquid_surface(object.bank->bank, level_m);
  known = {object.bank, level_m, surface ? renderer.add_mesh(*surface) : 0};
  return known.id;
}

void MeshStore::collect(SceneRenderer& renderer) {
  std::erase_if(liquids_, [&](const auto& entry) {
    const bool unused = entry.second.bank.expired();
    if (unused && entry.second.id != 0) renderer.remove_mesh(entry.second.id);
    return unused;
  });
  std::erase_if(banks_, [&](const auto& entry) {
    const bool unused = entry.second.bank.use_count() == 1;
    if (unused) renderer.remove_mesh(entry.second.mesh.id);
    return unused;
  });
}

Displacement Stage::displacement_of(const std::shared_ptr<const KnownBank>& bank, std::uint32_t rank) {
  if (bank != displaced_ || rank != displaced_mode_) {
    displaced_ = bank;
    displaced_mode_ = rank;
    displacement_ = mode_displacement(bank->bank, rank);
  }
  return displacement_;
}

void Stage::add(const MeshStore::Mesh& mesh, const glm::mat4& pose, float size, const KnownObject* object,
                StageItem item, const Commands& commands, double now_s) {
  const Choice& choice = commands.choice();
  DrawnBody body;
  body.id = static_cast<std::uint32_t>(contents_.items.size());
  body.mesh = mesh.id;
  body.pose = pose;
  body.size = size;
  body.colour = colour_of(object);
  body.selected = object && object->name == choice.object;
  if (object) body.glow = glow_of(object->peak, now_s - object->peak_at_s);
  if (body.selected && choice.vibrate && object->bank && choice.mode < object->bank->bank.mode_count()) {
    body.displacement = displacement_of(object->bank, choice.mode);
    const float diagonal = glm::length(mesh.shape.high_m - mesh.shape.low_m);
    body.displacement_m =
        kVibrationShare * diagonal * static_cast<float>(std::sin(2 * std::numbers::pi * kVibration_hz * now_s));
  }
  contents_.picked.push_back({body.id, &mesh.shape, pose, size});
  contents_.frame.bodies.push_back(std::move(body));
  contents_.items.push_back(std::move(item));
}

void Stage::add_body(const KnownBody& body, const Pose& pose, Model& model, const Commands& commands, double now_s) {
  const KnownObject* object = body.object.empty() ? nullptr : model.object(body.object);
  const StageItem item{body.id, body.object, mass_of(object, body.size_m)};
  if (object && object->bank) {
    add(meshes_.of_bank(object->bank, *renderer_), to_glm(pose), static_cast<float>(object->scale.size), object, item,
        commands, now_s);
  } else if (length(body.size_m) > 0) {
    add(meshes_.of_shape(body.shape, body.size_m, *renderer_), to_glm(pose), 1, object, item, commands, now_s);
  }
}

// Adds the objects that no body plays, side by side on the ground and beside the scene, so that they can be seen and
// struck. Low ones stand in front.
void Stage::add_bodiless(Model& model, const Commands& commands, double now_s) {
  std::unordered_set<std::string_view> played;
  for (const auto& [id, body] : model.scene().bodies()) played.insert(body.object);
  struct Thing {
    const KnownObject* object;
    const MeshStore::Mesh* mesh;
  };
  std::vector<Thing> things;
  for (const auto& [name, object] : model.objects()) {
    if (object.bank && !played.contains(name)) things.push_back({&object, &meshes_.of_bank(object.bank, *renderer_)});
  }
  if (things.empty()) return;
  std::ranges::stable_sort(things, {}, [](const Thing& t) { return t.mesh->shape.high_m.z - t.mesh->shape.low_m.z; });
  std::vector<glm::vec2> extents;
  for (const auto& [object, mesh] : things) {
    extents.push_back(static_cast<float>(object->scale.size) * glm::vec2(mesh->shape.high_m - mesh->shape.low_m));
  }
  const std::vector<glm::vec2> corners = on_shelves(extents);
  const glm::vec3 begin = beside_scene(model);
  for (std::size_t i = 0; i < things.size(); ++i) {
    const auto& [object, mesh] = things[i];
    const auto size = static_cast<float>(object->scale.size);
    const glm::vec3 position = begin + glm::vec3(corners[i], 0) - size * mesh->shape.low_m;
    add(*mesh, glm::translate(glm::mat4(1), position), size, object, {std::nullopt, object->name, mass_of(object, {})},
        commands, now_s);
  }
}

// Returns the place where the objects without a body begin: on the ground, to the right of all bodies that the scene
// has had so far, so that bodies in motion do not push them about.
glm::vec3 Stage::beside_scene(const Model& model) {
  constexpr float kGap_m = 0.1F;
  const std::string scene = model.scene().description().file.value_or("");
  if (scene != edge_of_) {
    edge_of_ = scene;
    edge_.reset();
  }
  for (std::size_t i = 0; i < contents_.items.size(); ++i) {
    const PickedBody& body = contents_.picked[i];
    const DrawnMesh& shape = *std::get<const DrawnMesh*>(body.shape);
    const glm::vec3 centre(body.pose * glm::vec4(body.size * (shape.low_m + shape.high_m) / 2.0F, 1));
    const float radius = body.size * glm::length(shape.high_m - shape.low_m) / 2;
    if (glm::length(centre) > kNear_m) continue;
    const glm::vec2 edge{centre.x + radius, centre.y - radius};
    edge_ = edge_ ? glm::vec2(std::max(edge_->x, edge.x), std::min(edge_->y, edge.y)) : edge;
  }
  float ground_m = lowest_fixed_m(model);
  for (const protocol::SceneStatic& known : model.scene().statics()) {
    const glm::vec3 normal = to_glm(Quaternion{known.x, known.y, known.z, known.w}) * glm::vec3(0, 0, 1);
    if (known.shape == "plane" && normal.z > 0.99F) ground_m = static_cast<float>(known.position_m.z);
  }
  return edge_ ? glm::vec3(edge_->x + kGap_m, edge_->y, ground_m) : glm::vec3(0, 0, ground_m);
}

void Stage::add_statics(const Model& model) {
  for (const protocol::SceneStatic& known : model.scene().statics()) {
    contents_.frame.statics.push_back({known.shape == "plane" ? StaticShape::plane : StaticShape::box,
                                       to_glm(known.position_m), to_glm(Quaternion{known.x, known.y, known.z, known.w}),
                                       to_glm(known.size_m)});
  }
  if (contents_.frame.statics.empty()) contents_.frame.statics.push_back({.position_m = {0, 0, lowest_fixed_m(model)}});
}

// Returns the height of the lowest point of all fixed bodies, and at most 0. A scene without statics is drawn with a
// ground plane at this height, so that a fixed table stands on the ground.
float Stage::lowest_fixed_m(const Model& model) const {
  float lowest = 0;
  for (std::size_t i = 0; i < contents_.items.size(); ++i) {
    const auto body =
        contents_.items[i].body ? model.scene().bodies().find(*contents_.items[i].body) : model.scene().bodies().end();
    if (body == model.scene().bodies().end() || !body->second.fixed) continue;
    const PickedBody& picked = contents_.picked[i];
    const DrawnMesh& shape = *std::get<const DrawnMesh*>(picked.shape);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::vec3 at{corner & 1 ? shape.high_m.x : shape.low_m.x, corner & 2 ? shape.high_m.y : shape.low_m.y,
                         corner & 4 ? shape.high_m.z : shape.low_m.z};
      lowest = std::min(lowest, (picked.pose * glm::vec4(picked.size * at, 1)).z);
    }
  }
  return lowest;
}

void Stage::add_flashes(const Model& model, double now_s) {
  for (const KnownContact& contact : model.contacts()) {
    const double age = (now_s - contact.at_s) / kFlash_s;
    if (age >= 1) continue;
    const auto item = std::ranges::find(contents_.items, contact.object, &StageItem::object);
    if (item == contents_.items.end()) continue;
    const glm::mat4& pose = contents_.frame.bodies[static_cast<std::size_t>(item - contents_.items.begin())].pose;
    const glm::vec3 blow = glm::mat3(pose) * to_glm(contact.impulse_ns);
    const float size = glm::length(blow);
    contents_.frame.flashes.push_back({glm::vec3(pose * glm::vec4(to_glm(contact.point_m), 1)),
                                       size > 0 ? -blow / size : glm::vec3(0, 0, 1), strength_of(contact.impulse_ns),
                                       static_cast<float>(std::max(age, 0.0))});
  }
}

void Stage::add_liquids(const Model& model, const Commands& commands) {
  for (std::size_t i = 0; i < contents_.items.size(); ++i) {
    const KnownObject* const object = model.object(contents_.items[i].object);
    if (!object || !object->bank || !object->bank->bank.levels) continue;
    const DrawnBody& vessel = contents_.frame.bodies[i];
    const double level_m = commands.edits().adjustment_of(*object).level_m / static_cast<double>(vessel.size);
    DrawnBody liquid{.id = vessel.id, .mesh = meshes_.of_liquid(*object, level_m, *renderer_), .pose = vessel.pose};
    liquid.size = vessel.size;
    liquid.colour = kLiquidColour;
    if (liquid.mesh != 0) contents_.frame.bodies.push_back(std::move(liquid));
  }
}

// Finds the sphere around everything that is drawn. It changes in steps, so that shadows do not swim.
void Stage::find_interest() {
  glm::vec3 low{1e9F}, high{-1e9F};
  for (std::size_t i = 0; i < contents_.frame.bodies.size(); ++i) {
    const DrawnBody& body = contents_.frame.bodies[i];
    const DrawnMesh& shape = *std::get<const DrawnMesh*>(contents_.picked[i].shape);
    const glm::vec3 centre(body.pose * glm::vec4(body.size * (shape.low_m + shape.high_m) / 2.0F, 1));
    const float radius = body.size * glm::length(shape.high_m - shape.low_m) / 2;
    if (glm::length(centre) > kFarAway_m) continue;
    low = glm::min(low, centre - radius);
    high = glm::max(high, centre + radius);
  }
  const Sphere now = low.x > high.x ? Sphere{{0, 0, 0.2F}, 1}
                                    : Sphere{(low + high) / 2.0F, std::max(0.2F, glm::length(high - low) / 2)};
  const bool fits = interest_ && glm::length(now.centre - interest_->centre) < 0.25F * interest_->radius_m &&
                    now.radius_m > 0.7F * interest_->radius_m && now.radius_m <= interest_->radius_m;
  if (!fits) interest_ = Sphere{now.centre, 1.15F * now.radius_m};
  contents_.frame.interest = *interest_;
}

const Stage::Contents& Stage::update(Model& model, const Commands& commands, SceneRenderer& renderer, bool dark,
                                     double now_s, std::optional<double> at_s) {
  renderer_ = &renderer;
  contents_ = {};
  meshes_.collect(renderer);
  contents_.frame.theme = dark ? Theme::dark : Theme::light;
  const auto time = at_s ? at_s : model.scene().shown_time_at(now_s);
  for (const auto& [id, body] : model.scene().bodies()) {
    if (!time) break;
    const auto pose = body.track.pose_at(*time);
    if (pose && model.scene().present(body)) add_body(body, *pose, model, commands, now_s);
  }
  add_bodiless(model, commands, now_s);
  add_statics(model);
  add_flashes(model, now_s);
  find_interest();
  add_liquids(model, commands);
  return contents_;
}

Camera Stage::home(const Model& model, float aspect) const {
  const protocol::SceneReply& scene = model.scene().description();
  if (scene.file && scene.field_of_view_degrees > 0) {
    const float field_of_view = glm::radians(static_cast<float>(scene.field_of_view_degrees));
    return Camera::from(to_glm(scene.camera_m), to_glm(scene.target_m),
                        Camera::fitted_field_of_view(field_of_view, aspect));
  }
  return Camera::showing(contents_.frame.interest, aspect);
}

}  // namespace ringdown::viewer
