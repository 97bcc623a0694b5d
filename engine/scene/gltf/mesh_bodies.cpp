#include "engine/scene/gltf/mesh_bodies.h"

#include "engine/base/quote.h"
#include "engine/scene/gltf/shapes.h"
#include "engine/scene/hull.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <utility>

namespace ringdown::scene {
namespace {

using modal::JsonPlace;

constexpr double kFull = 0.85;       // of its hull, at least, fills a body that may be its hull
constexpr double kSlabShare = 0.05;  // of its largest extent is the thickness of a flat mesh

std::set<std::size_t> animated_nodes(const JsonPlace& animations) {
  std::set<std::size_t> nodes;
  for (std::size_t k = 0; k < animations.size(); ++k) {
    const JsonPlace channels = animations[k]["channels"];
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const std::string path = channels[c]["target"]["path"].text_or("");
      const auto node = channels[c]["target"]["node"].index();
      if (node && (path == "translation" || path == "rotation")) nodes.insert(*node);
    }
  }
  return nodes;
}

// Returns the name of the first material of a node's mesh.
std::string material_of(const JsonPlace& root, const JsonPlace& node) {
  const auto mesh = node["mesh"].index();
  const JsonPlace meshes = root["meshes"], materials = root["materials"];
  if (!mesh || *mesh >= meshes.size()) return {};
  const JsonPlace primitives = meshes[*mesh]["primitives"];
  for (std::size_t k = 0; k < primitives.size(); ++k) {
    const auto material = primitives[k]["material"].index();
    if (material && *material < materials.size()) return materials[*material]["name"].text_or("");
  }
  return {};
}

double volume_of(const std::vector<Vec3>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  double volume = 0;
  const Vec3 base = points.front();
  for (const auto& [a, b, c] : triangles)
    volume += dot(points[a] - base, cross(points[b] - base, points[c] - base)) / 6;
  return volume;
}

// Returns true if each edge of the mesh has one triangle on either side.
bool is_closed(const ShapeMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = triangle[k], to = triangle[(k + 1) % 3];
      edges[std::minmax(from, to)] += from < to ? 1 : -1;
    }
  }
  return std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 0; });
}

// A flat mesh with a lower side, so that it has a thickness; nothing if it has no area. A sheet with two sides has no
// mean normal, and takes that of its largest triangle.
std::optional<ShapeMesh> slab_of(const ShapeMesh& mesh) {
  Vec3 sum, largest, low = mesh.points_m.front(), high = low;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 twice = cross(mesh.points_m[b] - mesh.points_m[a], mesh.points_m[c] - mesh.points_m[a]);
    sum = sum + twice;
    if (length(twice) > length(largest)) largest = twice;
  }
  for (const Vec3& p : mesh.points_m) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 normal = length(sum) > 0.5 * length(largest) ? sum : largest;
  if (!(length(normal) > 0)) return {};
  ShapeMesh slab = mesh;
  const Vec3 down = (-kSlabShare * length(high - low) / length(normal)) * normal;
  for (const Vec3& p : mesh.points_m) slab.points_m.push_back(p + down);
  return slab;
}

}  // namespace

std::vector<MeshBody> mesh_bodies(const JsonPlace& root, const std::vector<GltfNode>& nodes) {
  const std::set<std::size_t> animated = animated_nodes(root["animations"]);
  std::vector<MeshBody> bodies;
  if (animated.empty()) return bodies;
  std::map<std::size_t, std::size_t> by_node;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (!nodes[k].in_scene || !nodes[k].field["mesh"].present()) continue;
    bool has_physics = false;
    std::optional<std::size_t> moving;
    for (std::optional<std::size_t> at = k; at; at = nodes[*at].parent) {
      const JsonPlace physics = nodes[*at].field["extensions"][kPhysicsExtension];
      has_physics = has_physics || physics["motion"].present() || physics["collider"].present();
      if (!moving && animated.contains(*at)) moving = at;
    }
    if (has_physics) continue;
    const std::size_t node = moving.value_or(k);
    const auto [found, is_new] = by_node.try_emplace(node, bodies.size());
    if (is_new) bodies.push_back({.node = node});
    MeshBody& body = bodies[found->second];
    body.meshes.push_back(k);
    if (body.material.empty()) body.material = material_of(root, nodes[k].field);
  }
  return bodies;
}

std::optional<Shape> shape_of_meshes(GltfDocument& document, const MeshBody& body, const Affine& map) {
  ShapeMesh mesh = surface_of(document, body.meshes, map);
  const std::string who = "the mesh of " + quote(document.nodes()[body.node].name);
  if (!document.result() || mesh.triangles.empty()) {
    document.notes.add(who + " has no triangles, and touches nothing");
    return {};
  }
  if (mesh.points_m.size() > kMaxMeshPoints) {
    document.notes.add(formatted("{} has more than {} points, and touches nothing", who, kMaxMeshPoints));
    return {};
  }
  Shape shape{.type = ShapeType::trimesh};
  const auto hull = convex_hull(mesh.points_m);
  if (!hull) {
    auto slab = slab_of(mesh);
    if (!slab) {
      document.notes.add(who + " has no area, and touches nothing");
      return {};
    }
    document.notes.add(who + " is flat, and is taken for a slab below it");
    mesh = *std::move(slab);
    shape.type = ShapeType::convex;
  } else if (is_closed(mesh) &&
             volume_of(mesh.points_m, mesh.triangles) > kFull * volume_of(hull->points, hull->triangles)) {
    shape.type = ShapeType::convex;
  }
  shape.mesh = std::make_shared<const ShapeMesh>(std::move(mesh));
  return shape;
}

}  // namespace ringdown::scene
