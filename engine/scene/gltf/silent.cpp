#include "engine/scene/gltf/silent.h"

#include "engine/base/quote.h"
#include "engine/scene/gltf/document.h"
#include "engine/scene/gltf/mesh_bodies.h"
#include "engine/scene/gltf/shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <utility>

namespace ringdown::scene {
namespace {

using modal::JsonPlace;

constexpr double kEven = 1e-6;  // scales that differ by less are even

// A map that shifts, turns and stretches evenly, as gmsh takes it: 12 numbers, row by row.
std::string affine_text(const Affine& map) {
  std::ostringstream text;
  text.precision(17);
  const double shift[] = {map.shift_m.x, map.shift_m.y, map.shift_m.z};
  for (std::size_t row = 0; row < 3; ++row) {
    for (const double x : map.linear[row]) text << x << ", ";
    text << shift[row] << (row < 2 ? ", " : "");
  }
  return text.str();
}

bool is_identity(const Affine& map) {
  constexpr double kRounding = 1e-12;
  const Affine one;
  double off = length(map.shift_m);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column)
      off = std::max(off, std::abs(map.linear[row][column] - one.linear[row][column]));
  }
  return off < kRounding;
}

class SilentFinder {
 public:
  explicit SilentFinder(GltfDocument& document) : document_(document) {}

  Result<SilentBodies> find() {
    collect();
    SilentBodies found;
    for (auto& [node, colliders] : colliders_) {
      if (sounds(node)) continue;
      if (auto body = silent(node, colliders)) found.bodies.push_back(std::move(*body));
    }
    for (const MeshBody& mesh : mesh_bodies(document_.root(), document_.nodes())) {
      const auto plays = [this](std::size_t k) { return audio(k)["modalModel"].present(); };
      if (plays(mesh.node) || std::ranges::any_of(mesh.meshes, plays)) continue;
      meshes_ = mesh.meshes;
      auto body = silent(mesh.node, mesh.meshes, GltfMaterial{.name = mesh.material});
      if (body && body->surface.triangles.empty() && body->trouble.empty()) continue;
      if (body) found.bodies.push_back(std::move(*body));
    }
    if (const auto good = document_.result(); !good) return fail(good);
    found.notes = document_.notes.sentences();
    return found;
  }

 private:
  [[nodiscard]] const std::vector<GltfNode>& nodes() const { return document_.nodes(); }
  [[nodiscard]] JsonPlace physics(std::size_t node) const {
    return nodes()[node].field["extensions"][kPhysicsExtension];
  }
  [[nodiscard]] JsonPlace audio(std::size_t node) const { return nodes()[node].field["extensions"][kAudioExtension]; }
  [[nodiscard]] JsonPlace list(const char* name) const { return document_.root()["extensions"][kAudioExtension][name]; }

  template <class Has>
  [[nodiscard]] std::optional<std::size_t> nearest(std::size_t node, const Has& has) const {
    for (std::optional<std::size_t> at = node; at; at = nodes()[*at].parent) {
      if (has(*at)) return at;
    }
    return {};
  }
  [[nodiscard]] std::optional<std::size_t> motion_of(std::size_t node) const {
    return nearest(node, [this](std::size_t k) { return physics(k)["motion"].present(); });
  }

  // Sorts the colliders by the nodes of their bodies. Bodies with a motion and no collider are left out: they touch
  // nothing.
  void collect() {
    for (std::size_t k = 0; k < nodes().size(); ++k) {
      if (!nodes()[k].in_scene || !physics(k)["collider"].present()) continue;
      colliders_[motion_of(k).value_or(k)].push_back(k);
    }
  }

  // Returns whether a node of the body plays a model, or, without a motion, a node above the collider does.
  [[nodiscard]] bool sounds(std::size_t body) const {
    const auto plays = [this](std::size_t k) { return audio(k)["modalModel"].present(); };
    if (motion_of(body) != body) return nearest(body, plays).has_value();
    for (std::size_t k = 0; k < nodes().size(); ++k) {
      if (nodes()[k].in_scene && plays(k) && motion_of(k) == body) return true;
    }
    return false;
  }

  // `ordinary` is the material of a body that has no acoustic one.
  std::optional<SilentBody> silent(std::size_t node, const std::vector<std::size_t>& colliders,
                                   const std::optional<GltfMaterial>& ordinary = {}) {
    auto material = material_of(node, colliders);
    if (!material) material = ordinary;
    if (!material) return {};
    SilentBody body{.node = node, .name = nodes()[node].name, .material = *material};
    const Parts parts = parts_of(nodes()[node].world.linear);
    const Vec3 s = parts.scale;
    const double high = std::max({s.x, s.y, s.z}), low = std::min({s.x, s.y, s.z});
    if (!(low > 0) || parts.sheared || parts.mirrored || high - low > kEven * high) {
      body.trouble = "its node is scaled unevenly or mirrored; apply the scale to its mesh";
      return body;
    }
    body.scale = high - 1 < kEven && 1 - low < kEven ? 1 : s.x;
    // From the world to the node's frame, in metres: inverts its rotation and position, but not its scale.
    const Affine back = inverse(Pose{nodes()[node].world.shift_m, parts.rotation});
    body.surface = ordinary ? surface_of(document_, meshes_, back) : visible(node, back);
    if (body.surface.triangles.empty() && !ordinary) take_colliders(colliders, back, body);
    if (body.surface.triangles.empty() && body.geo.empty() && body.trouble.empty() && !ordinary) {
      document_.notes.add("a plane has no thickness to be baked, and stays silent");
      return {};
    }
    const auto is_near = [](Vec3 p) { return length(p) <= range::kPosition_m.high; };  // not where it overflowed
    if (!std::ranges::all_of(body.surface.points_m, is_near)) {
      body.surface = {};
      body.trouble = "its mesh reaches farther than 1000 m from its node";
    }
    const JsonPlace mass = physics(node)["motion"]["mass"];
    if (mass.present()) {
      const double mass_kg = document_.number(mass, 0);
      if (mass_kg > 0) body.mass_kg = mass_kg;
    }
    return body;
  }

  std::optional<GltfMaterial> material_of(std::size_t body, std::vector<std::size_t> from) {
    from.push_back(body);
    for (const std::size_t node : from) {
      const auto owner = nearest(node, [this](std::size_t k) { return audio(k)["acousticSurface"].present(); });
      if (!owner) continue;
      const JsonPlace surface = document_.element(audio(*owner)["acousticSurface"], list("acousticSurfaces"));
      const JsonPlace field = document_.element(surface["material"], list("acousticMaterials"));
      if (!field.present()) continue;
      GltfMaterial material{.number = surface["material"].index().value_or(0), .name = field["name"].text_or("")};
      const auto read = [&](const char* key, std::optional<double>& target) {
        if (field[key].present()) target = document_.number(field[key], 0);
      };
      read("density", material.density_kg_m3);
      read("youngsModulus", material.young_pa);
      read("poissonRatio", material.poisson);
      read("alpha", material.alpha_per_s);
      read("beta", material.beta_s);
      return material;
    }
    return {};
  }

  // The meshes at and below a node that move with it.
  ShapeMesh visible(std::size_t body, const Affine& back) {
    const bool moves = motion_of(body) == body;
    std::vector<std::size_t> open{body}, with_mesh;
    while (!open.empty()) {
      const std::size_t k = open.back();
      open.pop_back();
      if (k != body && (physics(k)["motion"].present() || (!moves && physics(k)["collider"].present()))) continue;
      if (nodes()[k].field["mesh"].present()) with_mesh.push_back(k);
      open.insert(open.end(), nodes()[k].children.begin(), nodes()[k].children.end());
    }
    std::ranges::sort(with_mesh);
    return surface_of(document_, with_mesh, back);
  }

  void take_colliders(const std::vector<std::size_t>& colliders, const Affine& back, SilentBody& body) {
    std::vector<Shape> meshes;
    std::string geo;
    int volumes = 0;
    bool has_plane = false;
    for (const std::size_t k : colliders) {
      const Affine map = back * nodes()[k].world;
      const JsonPlace geometry = geometry_of(physics(k)["collider"]);
      const JsonPlace shape = document_.element(geometry["shape"], shapes_of(document_.root()));
      if (geometry["node"].present() || shape["type"].text_or("") == "mesh") {
        if (const auto read = read_geometry(document_, geometry)) {
          if (auto placed = place(*read, map)) meshes.push_back(std::move(*placed));
        }
        continue;
      }
      has_plane = has_plane || shape["type"].text_or("") == "plane";
      geo += add_solid(shape, map, volumes);
    }
    if (volumes > 1) {
      geo += "BooleanUnion{ Volume{1}; Delete; }{ Volume{2";
      for (int k = 3; k <= volumes; ++k) geo += formatted(", {}", k);
      geo += "}; Delete; }\n";
    }
    if (volumes > 0 && meshes.empty()) body.geo = "SetFactory(\"OpenCASCADE\");\n" + geo;
    if (!meshes.empty()) body.surface = *join(meshes).mesh;
    if (!meshes.empty() && volumes > 0) {
      body.trouble = "it has no mesh of its own, and its colliders are meshes and implicit shapes; give it a mesh";
    } else if (meshes.empty() && volumes == 0 && !has_plane) {
      body.trouble = "it has neither a mesh nor a collider that encloses a solid";
    }
  }

  // A solid of OpenCASCADE for an implicit shape: its axis is y, its middle the node's origin.
  std::string add_solid(const JsonPlace& shape, const Affine& map, int& volumes) {
    const std::string type = shape["type"].text_or("");
    const JsonPlace own = shape[type];
    const auto size = [&](const JsonPlace& field, double fallback) {
      return std::abs(document_.number(field, fallback));
    };
    std::ostringstream text;
    text.precision(17);
    const auto ball = [&](int number, double y, double radius) {
      text << "Sphere(" << number << ") = {0, " << y << ", 0, " << radius << "};\n";
    };
    // A frustum from (0, y, 0) upwards; gmsh's cones have no equal radii.
    const auto frustum = [&](int number, double y, double height, double bottom, double top) {
      const bool straight = std::abs(bottom - top) <= 1e-9 * (bottom + top);
      text << (straight ? "Cylinder(" : "Cone(") << number << ") = {0, " << y << ", 0, 0, " << height << ", 0, "
           << bottom;
      if (!straight) text << ", " << top;
      text << "};\n";
    };
    std::vector<int> made{++volumes};
    const int first = volumes;
    if (type == "box") {
      const double x = size(own["size"][0], 1), y = size(own["size"][1], 1), z = size(own["size"][2], 1);
      text << "Box(" << first << ") = {" << -0.5 * x << ", " << -0.5 * y << ", " << -0.5 * z << ", " << x << ", " << y
           << ", " << z << "};\n";
    } else if (type == "sphere") {
      ball(first, 0, size(own["radius"], 0.5));
    } else if (type == "cylinder" || type == "capsule") {
      const double height = size(own["height"], 0.5);
      const double bottom = size(own["radiusBottom"], 0.25), top = size(own["radiusTop"], 0.25);
      if (type == "cylinder") {
        frustum(first, -0.5 * height, height, bottom, top);
      } else if (std::abs(bottom - top) >= height) {  // one ball holds the other
        ball(first, bottom > top ? -0.5 * height : 0.5 * height, std::max(bottom, top));
      } else {
        // The balls touch the cone along circles that are offset from their middles according to the cone's slope.
        const double slope = (bottom - top) / height, across = std::sqrt(1 - slope * slope);
        const double low = -0.5 * height + bottom * slope, high = 0.5 * height + top * slope;
        frustum(first, low, high - low, bottom * across, top * across);
        for (const auto& [y, radius] : {std::pair(-0.5 * height, bottom), {0.5 * height, top}}) {
          if (radius > 0) ball(++volumes, y, radius), made.push_back(volumes);
        }
      }
    } else {
      --volumes;
      return {};
    }
    if (!is_identity(map)) {
      text << "Affine{" << affine_text(map) << "} { Volume{" << made[0];
      for (std::size_t k = 1; k < made.size(); ++k) text << ", " << made[k];
      text << "}; }\n";
    }
    return text.str();
  }

  GltfDocument& document_;
  std::map<std::size_t, std::vector<std::size_t>> colliders_;
  std::vector<std::size_t> meshes_;  // of the body without physics that is looked at
};

}  // namespace

bool has_mesh_bodies(const modal::Glb& glb) {
  auto document = GltfDocument::read(glb);
  return document && !mesh_bodies(document->root(), document->nodes()).empty();
}

Result<SilentBodies> find_silent_bodies(const modal::Glb& glb) {
  auto document = GltfDocument::read(glb);
  if (!document) return fail(document);
  return SilentFinder(*document).find();
}

}  // namespace ringdown::scene
