#include "engine/scene/gltf/scene.h"

#include "engine/base/content_hash.h"
#include "engine/base/file_format.h"
#include "engine/base/object_name.h"
#include "engine/base/quote.h"
#include "engine/base/within_memory.h"
#include "engine/gltf/gltf_file.h"
#include "engine/modal/bank_file.h"
#include "engine/scene/check.h"
#include "engine/scene/gltf/animation.h"
#include "engine/scene/gltf/camera.h"
#include "engine/scene/gltf/document.h"
#include "engine/scene/gltf/joints.h"
#include "engine/scene/gltf/mesh_bodies.h"
#include "engine/scene/gltf/normal_map.h"
#include "engine/scene/gltf/shapes.h"
#include "engine/scene/gltf/surface.h"
#include "engine/scene/motion_path.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/scene_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

namespace ringdown::scene {
namespace {

using modal::JsonPlace;

constexpr double kUsualDensity_kg_m3 = 1000;

// Extensions that are read here or that change nothing about a scene's motion and sound.
constexpr std::array kKnown = {"KHR_physics_rigid_bodies", "KHR_implicit_shapes",     "KHR_collision_shapes",
                               "KHR_audio_rigid_bodies",   "EXT_meshopt_compression", "KHR_mesh_quantization"};

// A collider, and where its node lies.
struct PlacedCollider {
  std::size_t node = 0;
  GltfGeometry geometry;
  FrictionSurface surface;
  CollisionFilter filter;
};

// A motion, or a collider without one, and everything that moves with it.
struct GatheredBody {
  std::size_t node = 0;
  bool moves = false;
  std::vector<PlacedCollider> colliders;
  std::optional<std::size_t> model_node;
  MeshBody meshes = {};  // of a body without physics
};

JsonPlace physics_of(const GltfNode& node) { return node.field["extensions"][kPhysicsExtension]; }
JsonPlace audio_of(const GltfNode& node) { return node.field["extensions"][kAudioExtension]; }

// Returns whether a file describes two surfaces identically.
bool same(const FrictionSurface& a, const FrictionSurface& b) {
  const auto all = [](const FrictionSurface& s) {
    return std::tie(s.friction, s.sliding_friction, s.restitution, s.friction_combine, s.restitution_combine,
                    s.rolling_m, s.young_pa, s.poisson, s.waviness, s.texture.roughness_m, s.texture.correlation_m,
                    s.texture.spectral_slope, s.texture.shortest_m);
  };
  return all(a) == all(b) && (a.relief == nullptr) == (b.relief == nullptr);
}

class GltfSceneReader {
 public:
  GltfSceneReader(GltfDocument& document, std::filesystem::path path, const modal::ReadBeside& read_beside,
                  const std::optional<FoleyLimits>& foley, const std::optional<std::string>& camera)
      : document_(document),
        path_(std::move(path)),
        read_beside_(read_beside),
        camera_(camera),
        animations_(document, foley) {
    scene_.foley = foley;
  }

  Result<GltfScene> read() {
    note_what_is_left_out();
    collect();
    for (const GatheredBody& body : bodies_) add(body);
    if (scene_.foley && animations_.length_s() > 0) scene_.duration_s = std::max(animations_.length_s(), 0.01);
    if (const auto good = document_.result(); !good) return fail(good);
    add_joints();
    if (const auto added = add_camera(animations_, camera_, scene_); !added) return fail(path_.string(), added);
    if (const auto good = document_.result(); !good) return fail(good);
    if (const auto good = check(scene_); !good) return fail(path_.string(), good);
    return GltfScene{std::move(scene_), document_.notes.sentences()};
  }

 private:
  [[nodiscard]] const std::vector<GltfNode>& nodes() const { return document_.nodes(); }
  [[nodiscard]] JsonPlace list(const char* extension, const char* name) const {
    return document_.root()["extensions"][extension][name];
  }
  void note(const std::string& sentence) { document_.notes.add(sentence); }

  void note_what_is_left_out() {
    const JsonPlace required = document_.root()["extensionsRequired"];
    for (const std::string& name : document_.texts(required)) {
      if (std::ranges::find(kKnown, name) == kKnown.end())
        note("the file requires the extension " + quote(name) + ", which scenes do not use");
    }
    if (document_.root()["extensions"]["KHR_interactivity"].present())
      note("behaviour graphs of KHR_interactivity are not run");
    if (document_.root()["extensions"]["KHR_audio_emitter"].present())
      note("audio emitters are not played; modal models sound from their own nodes");
    const JsonPlace animations = document_.root()["animations"];
    for (std::size_t k = 0; k < animations.size(); ++k) {
      const JsonPlace channels = animations[k]["channels"];
      for (std::size_t c = 0; c < channels.size(); ++c) {
        if (channels[c]["target"]["extensions"]["KHR_animation_pointer"].present())
          note("animations by KHR_animation_pointer are not played");
      }
    }
    for (const GltfNode& node : nodes()) {
      if (!node.in_scene) continue;
      if (physics_of(node)["trigger"].present())
        note("triggers have no effect: nothing collides with them, and bodies that enter them are not reported");
      if (node.field["extensions"]["EXT_mesh_gpu_instancing"].present())
        note("instances by EXT_mesh_gpu_instancing are not played");
    }
  }

  // The nearest node that is, or is above, this one and for which `has` holds.
  template <class Has>
  [[nodiscard]] std::optional<std::size_t> nearest(std::size_t node, const Has& has) const {
    for (std::optional<std::size_t> at = node; at; at = nodes()[*at].parent) {
      if (has(nodes()[*at])) return at;
    }
    return {};
  }

  [[nodiscard]] std::optional<std::size_t> motion_of(std::size_t node) const {
    return nearest(node, [](const GltfNode& n) { return physics_of(n)["motion"].present(); });
  }

  // Returns the node of the body that a collider or a model belongs to: the node of the motion; without a motion, the
  // nearest node with a modal model, else its own node.
  [[nodiscard]] std::size_t owner_of(std::size_t node) const {
    if (const auto motion = motion_of(node)) return *motion;
    return nearest(node, [](const GltfNode& n) { return audio_of(n)["modalModel"].present(); }).value_or(node);
  }

  // Sorts colliders and models by the bodies that they belong to.
  void collect() {
    std::map<std::size_t, std::size_t> by_node;
    const auto body_at = [&](std::size_t node, bool moves) -> GatheredBody& {
      const auto [found, is_new] = by_node.try_emplace(node, bodies_.size());
      if (is_new) bodies_.push_back({.node = node, .moves = moves});
      return bodies_[found->second];
    };
    for (std::size_t k = 0; k < nodes().size(); ++k) {
      if (!nodes()[k].in_scene) continue;
      const std::optional<std::size_t> motion = motion_of(k);
      const JsonPlace collider = physics_of(nodes()[k])["collider"];
      const bool plays = audio_of(nodes()[k])["modalModel"].present();
      if (motion == k) body_at(k, true);
      if (collider.present()) {
        if (auto read = read_collider(k, collider))
          body_at(owner_of(k), motion.has_value()).colliders.push_back(std::move(*read));
      }
      if (!plays) continue;
      GatheredBody& body = body_at(owner_of(k), motion.has_value());
      if (body.model_node) note("a body plays one modal model; further ones below it are not loaded");
      if (!body.model_node) body.model_node = k;
    }
    if (!scene_.foley) return;
    for (MeshBody& found : mesh_bodies(document_.root(), document_.nodes())) {
      GatheredBody& body = body_at(found.node, false);
      for (const std::size_t mesh : found.meshes) {
        if (!body.model_node && audio_of(nodes()[mesh])["modalModel"].present()) body.model_node = mesh;
        if (mesh != found.node && by_node.contains(mesh)) bodies_[by_node[mesh]].model_node.reset();
      }
      body_at(found.node, false).meshes = std::move(found);
    }
  }

  std::optional<PlacedCollider> read_collider(std::size_t node, const JsonPlace& field) {
    auto geometry = read_geometry(document_, geometry_of(field));
    if (!geometry) return {};
    PlacedCollider collider{.node = node, .geometry = std::move(*geometry)};
    const JsonPlace material = document_.element(field["physicsMaterial"], list(kPhysicsExtension, "physicsMaterials"));
    if (material.present()) read_friction(document_, material, collider.surface);
    const JsonPlace filter = document_.element(field["collisionFilter"], list(kPhysicsExtension, "collisionFilters"));
    if (filter.present()) {
      collider.filter = {document_.texts(filter["collisionSystems"]), document_.texts(filter["collideWithSystems"]),
                         document_.texts(filter["notCollideWithSystems"])};
    }
    read_surface(node, collider.surface);
    return collider;
  }

  // The acoustic surface of a node or of the nearest one above it; without one, that of a machined surface.
  void read_surface(std::size_t node, FrictionSurface& surface) {
    const auto owner = nearest(node, [](const GltfNode& n) { return audio_of(n)["acousticSurface"].present(); });
    const JsonPlace finish = owner ? document_.element(audio_of(nodes()[*owner])["acousticSurface"],
                                                       list(kAudioExtension, "acousticSurfaces"))
                                   : JsonPlace(nullptr, "");
    read_finish(document_, finish, surface);
    const JsonPlace material = document_.element(finish["material"], list(kAudioExtension, "acousticMaterials"));
    if (material["youngsModulus"].present()) surface.young_pa = document_.number(material["youngsModulus"], 0);
    if (material["poissonRatio"].present()) surface.poisson = document_.number(material["poissonRatio"], 0);
    surface.relief = relief(node, owner, finish);
  }

  // Returns the heights of a collider's surface, if the file has any. Each profile or map is read once for each
  // surface, mesh and size.
  std::shared_ptr<const modal::SurfaceRelief> relief(std::size_t node, std::optional<std::size_t> owner,
                                                     const JsonPlace& finish) {
    auto mesh_node = nearest(node, [](const GltfNode& n) { return n.field["mesh"].present(); });
    const auto other = geometry_of(physics_of(nodes()[node])["collider"])["node"].index();
    if (other && *other < nodes().size() && nodes()[*other].field["mesh"].present()) mesh_node = *other;
    const Affine& world = nodes()[node].world;
    const Vec3 s = parts_of(world.linear).scale;
    const std::tuple key{owner.value_or(nodes().size()), mesh_node.value_or(nodes().size()), s.x, s.y, s.z};
    const auto [found, is_new] = reliefs_.try_emplace(key);
    if (!is_new) return found->second;
    modal::SurfaceRelief relief{.profile = read_profile(document_, finish)};
    if (mesh_node) {
      const JsonPlace mesh = document_.element(nodes()[*mesh_node].field["mesh"], document_.root()["meshes"]);
      relief.mesoscale = relief_of(document_, finish["normalTexture"], mesh, world, maps_ < kMaxMaps, read_beside_);
      if (relief.mesoscale) ++maps_;
    }
    if (relief.profile || relief.mesoscale) found->second = std::make_shared<modal::SurfaceRelief>(std::move(relief));
    return found->second;
  }

  // A body's frame: that of its model, else of its only collider, else its own.
  static std::size_t frame_node(const GatheredBody& body) {
    if (body.model_node) return *body.model_node;
    return body.colliders.size() == 1 ? body.colliders[0].node : body.node;
  }

  [[nodiscard]] Pose frame_of(const GatheredBody& body) const {
    const Affine& world = nodes()[frame_node(body)].world;
    return {world.shift_m, parts_of(world.linear).rotation};
  }

  void add(const GatheredBody& body) {
    const Pose frame = frame_of(body);
    std::vector<Shape> shapes;
    bool is_plane = false;
    for (const PlacedCollider& collider : body.colliders) {
      const Affine map = inverse(frame) * nodes()[collider.node].world;
      if (auto shape = place(collider.geometry, map)) {
        shapes.push_back(std::move(*shape));
      } else if (collider.geometry.kind == GltfGeometry::plane && collider.geometry.size_m == Vec3{}) {
        is_plane = true;
        add_plane(body, collider);
      } else {
        note("a collider with a scale of 0 is left out");
      }
    }
    if (!body.meshes.meshes.empty()) {
      if (auto shape = shape_of_meshes(document_, body.meshes, inverse(frame))) shapes.push_back(std::move(*shape));
    } else if (shapes.empty()) {
      if (!is_plane && body.moves) note("a motion without a collider touches nothing, and is left out");
      if (!body.moves && body.model_node)
        note(is_plane ? "a modal model of an infinite plane is not loaded"
                      : "a modal model of a node without a motion or a collider cannot be struck; it is not loaded");
    }
    if (shapes.empty()) return;
    for (const PlacedCollider& other : body.colliders) {
      const PlacedCollider& first = body.colliders[0];
      if (!(other.filter == first.filter && same(other.surface, first.surface)))
        note("colliders of one body have one material, one acoustic surface and one filter: those of the first");
    }
    for (const Shape& shape : shapes) points_ += shape.mesh ? shape.mesh->points_m.size() : 0;
    if (points_ > kMaxScenePoints)
      return document_.refuse(document_.root()["meshes"].wrong("fewer points in all colliders together"));
    BodyDescription made{.name = unique_body(nodes()[body.node].name), .shape = join(shapes)};
    made.position_m = frame.position_m;
    made.rotation = frame.rotation;
    if (body.colliders.empty()) {
      read_surface(body.meshes.meshes[0], made.surface);
    } else {
      made.surface = body.colliders[0].surface;
      made.filter = body.colliders[0].filter;
    }
    made.fixed = !body.moves;
    made.two_way = is_two_way(body.node);
    if (body.model_node) add_object(*body.model_node, made);
    if (body.moves) add_motion(body, frame, made);
    if (auto path = animations_.path_of(frame_node(body))) {
      made.fixed = true;
      made.velocity_m_s = made.spin_rad_s = {};
      made.position_m = path->poses[0].position_m, made.rotation = path->poses[0].rotation;
      made.path = std::move(path);
      made.start_s = animations_.appears_s(frame_node(body));
      if (scene_.foley && !made.mass && (made.object.empty() || !has_mass_))
        made.mass = mass_of(made.shape, kUsualDensity_kg_m3);
    }
    names_[body.node] = made.name;
    scene_.bodies.push_back(std::move(made));
  }

  // Our own extra of a body's node, which no draft has: "ringdown": {"contact": "two-way"}.
  bool is_two_way(std::size_t node) {
    const JsonPlace contact = nodes()[node].field["extras"]["ringdown"]["contact"];
    const std::string way = contact.text_or("");
    if (contact.present() && way != "one-way" && way != "two-way")
      document_.refuse(contact.wrong("one-way or two-way"));
    return way == "two-way";
  }

  void add_plane(const GatheredBody& body, const PlacedCollider& collider) {
    if (body.moves) return note("an infinite plane cannot move, and is left out");
    StaticDescription plane = place_plane(collider.geometry, nodes()[collider.node].world);
    plane.name = nodes()[collider.node].name;
    for (int k = 2; std::ranges::count(scene_.statics, plane.name, &StaticDescription::name) > 0; ++k)
      plane.name = formatted("{}-{}", nodes()[collider.node].name, k);
    plane.surface = collider.surface;
    plane.filter = collider.filter;
    scene_.statics.push_back(std::move(plane));
  }

  // The object of a node that plays a model, with the node's scale and gain.
  void add_object(std::size_t number, BodyDescription& body) {
    const GltfNode& node = nodes()[number];
    const JsonPlace reference = audio_of(node)["modalModel"];
    const JsonPlace model = document_.element(reference, list(kAudioExtension, "modalModels"));
    if (!model.present()) return;
    const Parts parts = parts_of(node.world.linear);
    const Vec3 s = parts.scale;
    if (parts.sheared || parts.mirrored || std::max({s.x, s.y, s.z}) - std::min({s.x, s.y, s.z}) > 1e-6 * s.x)
      return note("a modal model under an uneven or a mirrored scale is silent; it needs a bake at that scale");
    ObjectDescription object{.name = unique_object(node.name)};
    // A model was made for its node at the scale that the file gives it, which moves the points and nothing else.
    const double scale = std::abs(s.x - 1) < 1e-6 ? 1 : s.x;
    if (!modal::kBankPathScale.holds(scale)) return note("a modal model under a scale beyond 1e-6 to 1e6 is silent");
    object.bank = modal::bank_path({path_, {reference.index().value_or(0), scale}});
    object.gain = document_.number(audio_of(node)["gain"], 1);
    body.object = object.name;
    has_mass_ = model["massProperties"].present();
    scene_.objects.push_back(std::move(object));
  }

  void add_motion(const GatheredBody& body, const Pose& frame, BodyDescription& made) {
    const GltfNode& node = nodes()[body.node];
    const JsonPlace motion = physics_of(node)["motion"];
    const Rotation turn = parts_of(node.world.linear).rotation;
    made.velocity_m_s = rotated(turn, document_.vector(motion["linearVelocity"], {}));
    made.spin_rad_s = rotated(turn, document_.vector(motion["angularVelocity"], {}));
    made.gravity_factor = document_.number(motion["gravityFactor"], 1);
    if (document_.flag(motion["isKinematic"], false)) {
      made.fixed = true;
      if (made.velocity_m_s != Vec3{} || made.spin_rad_s != Vec3{}) {
        made.path = std::make_shared<MotionPath>(MotionPath{{}, 0, false, made.velocity_m_s, made.spin_rad_s});
        made.velocity_m_s = made.spin_rad_s = {};
      }
      if (!scene_.foley) return;
    }
    const bool own =
        motion["mass"].present() || motion["inertiaDiagonal"].present() || motion["centerOfMass"].present();
    if (!own && !made.object.empty() && has_mass_) return;
    modal::MassProperties mass = mass_of(made.shape, kUsualDensity_kg_m3);
    if (motion["mass"].present()) {
      double wanted_kg = document_.number(motion["mass"], 1);
      if (wanted_kg == 0)
        note(formatted("an infinite mass is replaced by {} kg", static_cast<int>(range::kMass_kg.high)));
      if (wanted_kg == 0) wanted_kg = range::kMass_kg.high;
      if (!range::kMass_kg.holds(wanted_kg)) return document_.refuse(motion["mass"].wrong("0, or 1e-7 to 1e7 kg"));
      mass.inertia_kg_m2 = (wanted_kg / mass.mass_kg) * mass.inertia_kg_m2;
      mass.mass_kg = wanted_kg;
    }
    const Affine to_frame = inverse(frame) * node.world;
    if (motion["centerOfMass"].present())
      mass.center_of_mass_m = to_frame * document_.vector(motion["centerOfMass"], {});
    if (motion["inertiaDiagonal"].present()) {
      const Vec3 moments = document_.vector(motion["inertiaDiagonal"], {});
      const Rotation axes = inverse(frame.rotation) * turn * document_.rotation(motion["inertiaOrientation"]);
      set_moments(moments, mass);
      mass.orientation = {axes.x, axes.y, axes.z, axes.w};
    }
    made.mass = mass;
  }

  // Moments of 0 are infinite: here a million times the largest other one, or the one that the shape would have.
  void set_moments(Vec3 moments, modal::MassProperties& mass) {
    constexpr double kInfinite = 1e6;
    const Vec3 usual = mass.inertia_kg_m2;
    double largest = std::max({moments.x, moments.y, moments.z});
    if (largest == 0) largest = std::max({usual.x, usual.y, usual.z});
    const auto or_infinite = [&](double moment) {
      if (moment == 0) note("infinite moments of inertia are replaced by a million times the others");
      return moment == 0 ? kInfinite * largest : moment;
    };
    mass.inertia_kg_m2 = {or_infinite(moments.x), or_infinite(moments.y), or_infinite(moments.z)};
  }

  void add_joints() {
    for (const GltfNode& node : nodes()) {
      const JsonPlace joint = physics_of(node)["joint"];
      if (!node.in_scene || !joint.present()) continue;
      const auto other = joint["connectedNode"].index();
      if (!other || *other >= nodes().size() || !nodes()[*other].in_scene)
        return document_.refuse(joint["connectedNode"].wrong("the number of a node of the scene"));
      const std::size_t number = static_cast<std::size_t>(&node - nodes().data());
      add_joint(document_, joint, {node, body_of(number)}, {nodes()[*other], body_of(*other)}, scene_);
    }
  }

  // The name of the body that a node moves with, or that stands still with it; empty for the world.
  [[nodiscard]] std::string body_of(std::size_t node) const {
    auto owner = motion_of(node);
    if (!owner) owner = nearest(node, [](const GltfNode& n) { return physics_of(n)["collider"].present(); });
    const auto found = owner ? names_.find(owner_of(*owner)) : names_.end();
    return found == names_.end() ? "" : found->second;
  }

  std::string unique_body(const std::string& wanted) const {
    std::string name = wanted;
    for (int k = 2; std::ranges::count(scene_.bodies, name, &BodyDescription::name) > 0; ++k)
      name = formatted("{}-{}", wanted, k);
    return name;
  }

  // A name of an object (object_name.h) that is most like a node's.
  std::string unique_object(const std::string& wanted) const {
    std::string plain = wanted.substr(0, kMaxName - 6);
    for (char& letter : plain) {
      if (!is_object_name(std::string("a") + letter)) letter = '_';
    }
    if (!is_object_name(plain)) plain = "n" + plain;
    std::string name = plain;
    for (int k = 2; std::ranges::count(scene_.objects, name, &ObjectDescription::name) > 0; ++k)
      name = formatted("{}-{}", plain, k);
    return name;
  }

  GltfDocument& document_;
  std::filesystem::path path_;
  const modal::ReadBeside& read_beside_;
  const std::optional<std::string>& camera_;
  GltfAnimations animations_;
  std::map<std::tuple<std::size_t, std::size_t, double, double, double>, std::shared_ptr<const modal::SurfaceRelief>>
      reliefs_;           // by surface, mesh and size
  std::size_t maps_ = 0;  // normal maps among them
  std::vector<GatheredBody> bodies_;
  std::map<std::size_t, std::string> names_;  // of the bodies, by their nodes
  std::size_t points_ = 0;
  bool has_mass_ = false;  // whether the model of the last object has a mass
  SceneDescription scene_;
};

}  // namespace

std::string fingerprint(const SceneDescription& scene) {
  SceneDescription own = scene;
  for (ObjectDescription& object : own.objects) {
    const std::string bank = object.bank.string();
    object.bank = bank.substr(std::min(bank.rfind('#'), bank.size()));
  }
  return hash_of(to_toml(own)).text();
}

bool is_gltf(const std::filesystem::path& path) { return is_of_kind(path, FileKind::gltf); }

Result<GltfScene> parse_gltf_scene(std::span<const std::byte> bytes, const std::filesystem::path& path,
                                   const modal::ReadBeside& read_beside, const std::optional<FoleyLimits>& foley,
                                   const std::optional<std::string>& camera) {
  return within_memory("read " + path.string(), [&]() -> Result<GltfScene> {
    const auto glb = modal::parse_gltf(bytes, path.string(), read_beside);
    if (!glb) return fail(glb);
    auto document = GltfDocument::read(*glb);
    if (!document) return fail(document);
    auto read = GltfSceneReader(*document, path, read_beside, foley, camera).read();
    const JsonPlace own = glb->root()["extras"]["ringdown"];
    if (read && foley) {
      const auto step_s = own["step_s"].number_or(read->scene.step_s);
      if (step_s && range::kStep_s.holds(*step_s)) read->scene.step_s = *step_s;
    }
    if (!read || !own["scene"].present() || foley) return read;
    if (own["fingerprint"].text_or("") != fingerprint(read->scene)) {
      read->notes.push_back(
          "another program has changed what Ringdown wrote; its own settings in the file are not used");
      return read;
    }
    auto exact = parse_scene(own["scene"].text_or(""), path, {});
    if (!exact) return fail(exact);
    if (camera) exact->listener = read->scene.listener;
    return GltfScene{*std::move(exact), {}};
  });
}

}  // namespace ringdown::scene
