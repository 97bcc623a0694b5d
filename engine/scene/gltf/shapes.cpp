#include "engine/scene/gltf/shapes.h"

#include "engine/scene/hull.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace ringdown::scene {
namespace {

using modal::JsonPlace;

constexpr int kAround = 32;      // corners of a cylinder's end
constexpr int kBallAround = 12;  // of a ball's circles of latitude
constexpr int kBallRings = 4;    // of half a ball, besides its pole
constexpr double kThinnest_m = 1e-4;
constexpr double kPlaneThickness = 0.1;  // of a finite plane, as a share of its shorter side
constexpr double kSheet_m = 2e-3;        // the thickness of a double-sided plane

// A circle of corners about the y axis.
void add_ring(ShapeMesh& mesh, double radius_m, double y_m, int corners) {
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    mesh.points_m.push_back({radius_m * std::cos(angle), y_m, radius_m * std::sin(angle)});
  }
}

// Half a ball about (0, y, 0), or the pole alone where there is no radius. `up` is 1 or -1.
void add_cap(ShapeMesh& mesh, double radius_m, double y_m, double up) {
  mesh.points_m.push_back({0, y_m + up * radius_m, 0});
  if (radius_m == 0) return;
  for (int ring = 0; ring < kBallRings; ++ring) {
    const double angle = 0.5 * std::numbers::pi * ring / kBallRings;
    add_ring(mesh, radius_m * std::cos(angle), y_m + up * radius_m * std::sin(angle), kBallAround);
  }
}

std::shared_ptr<const ShapeMesh> hull_of(const ShapeMesh& mesh) {
  auto hull = convex_hull(mesh.points_m);
  if (!hull) return nullptr;
  return std::make_shared<const ShapeMesh>(ShapeMesh{std::move(hull->points), std::move(hull->triangles)});
}

ShapeMesh cylinder(double height_m, double bottom_m, double top_m) {
  ShapeMesh mesh;
  for (const auto& [radius_m, y_m] : {std::pair(bottom_m, -0.5 * height_m), {top_m, 0.5 * height_m}}) {
    if (radius_m > 0) add_ring(mesh, radius_m, y_m, kAround);
    if (radius_m == 0) mesh.points_m.push_back({0, y_m, 0});
  }
  return mesh;
}

ShapeMesh capsule(double height_m, double bottom_m, double top_m) {
  ShapeMesh mesh;
  add_cap(mesh, bottom_m, -0.5 * height_m, -1);
  add_cap(mesh, top_m, 0.5 * height_m, 1);
  return mesh;
}

ShapeMesh ball(double radius_m) { return capsule(0, radius_m, radius_m); }

ShapeMesh box_mesh(Vec3 size_m) {
  ShapeMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.points_m.push_back({(corner & 1 ? 0.5 : -0.5) * size_m.x, (corner & 2 ? 0.5 : -0.5) * size_m.y,
                             (corner & 4 ? 0.5 : -0.5) * size_m.z});
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

ShapeMesh moved(const ShapeMesh& mesh, const Affine& map) {
  ShapeMesh out = mesh;
  for (Vec3& p : out.points_m) p = map * p;
  if (parts_of(map.linear).mirrored) {
    for (auto& [a, b, c] : out.triangles) std::swap(b, c);
  }
  return out;
}

void append(ShapeMesh& mesh, const ShapeMesh& more) {
  const auto first = static_cast<std::uint32_t>(mesh.points_m.size());
  mesh.points_m.insert(mesh.points_m.end(), more.points_m.begin(), more.points_m.end());
  for (const auto& [a, b, c] : more.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
}

// Adds a mesh's triangles, which lie by `map` in the geometry's frame.
void add_mesh(GltfDocument& document, const JsonPlace& mesh, const Affine& map, ShapeMesh& target) {
  if (mesh["primitives"][0]["targets"].present())
    document.notes.add("morph targets of a mesh are not used for its collisions");
  for (std::size_t k = 0; k < mesh["primitives"].size(); ++k) {
    const JsonPlace primitive = mesh["primitives"][k];
    const auto mode = primitive["mode"].index_or(4);
    if (!mode || *mode != 4 || primitive["extensions"]["KHR_draco_mesh_compression"].present()) {
      document.notes.add(
          "collisions need meshes of plain triangles (mode 4, not packed by Draco); others are left out");
      continue;
    }
    const auto positions =
        modal::read_numbers(document.glb(), primitive["attributes"]["POSITION"], 3, 4 * kMaxMeshPoints);
    if (!positions) return document.refuse(fail(positions));
    ShapeMesh part;
    for (std::size_t p = 0; p < positions->size(); p += 3)
      part.points_m.push_back({(*positions)[p], (*positions)[p + 1], (*positions)[p + 2]});
    std::vector<std::uint32_t> corners;
    if (primitive["indices"].present()) {
      auto indices = modal::read_indices(document.glb(), primitive["indices"], 12 * kMaxMeshPoints);
      if (!indices) return document.refuse(fail(indices));
      corners = *std::move(indices);
    } else {
      for (std::uint32_t c = 0; c < part.points_m.size(); ++c) corners.push_back(c);
    }
    for (std::size_t c = 0; c + 2 < corners.size(); c += 3) {
      if (std::max({corners[c], corners[c + 1], corners[c + 2]}) >= part.points_m.size())
        return document.refuse(primitive["indices"].wrong("an accessor whose numbers are those of points"));
      part.triangles.push_back({corners[c], corners[c + 1], corners[c + 2]});
    }
    append(target, moved(part, map));
  }
}

// Merges points in one place: meshes made for pictures have several points for each corner, with different normals, and
// a collision mesh must be closed.
ShapeMesh welded(const ShapeMesh& mesh) {
  const auto less = [](Vec3 a, Vec3 b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
  ShapeMesh out;
  out.points_m = mesh.points_m;
  std::ranges::sort(out.points_m, less);
  const auto rest = std::ranges::unique(out.points_m);
  out.points_m.erase(rest.begin(), rest.end());
  const auto number = [&](std::uint32_t corner) {
    const auto found = std::ranges::lower_bound(out.points_m, mesh.points_m[corner], less);
    return static_cast<std::uint32_t>(found - out.points_m.begin());
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::array triangle{number(a), number(b), number(c)};
    const Vec3 side = out.points_m[triangle[1]] - out.points_m[triangle[0]];
    const Vec3 other = out.points_m[triangle[2]] - out.points_m[triangle[0]];
    if (length(cross(side, other)) > 0) out.triangles.push_back(triangle);
  }
  return out;
}

// Triangles as a hull or as a mesh. `reference` names them in sentences.
std::optional<GltfGeometry> made_of(GltfDocument& document, const ShapeMesh& triangles, bool is_hull,
                                    const JsonPlace& reference) {
  if (!document.result()) return {};
  ShapeMesh mesh = welded(triangles);
  if (mesh.points_m.size() > kMaxMeshPoints) {
    document.refuse(reference.wrong(formatted("a reference to meshes of at most {} points", kMaxMeshPoints)));
    return {};
  }
  if (mesh.triangles.empty()) {
    document.notes.add("a collider's node " + reference.path() + " has no mesh; the collider is left out");
    return {};
  }
  if (!is_hull) return GltfGeometry{.kind = GltfGeometry::mesh, .points = std::make_shared<ShapeMesh>(std::move(mesh))};
  auto hull = hull_of(mesh);
  if (!hull) {
    document.notes.add("the points of a convex collider lie in one plane; the collider is a mesh instead");
    return GltfGeometry{.kind = GltfGeometry::mesh, .points = std::make_shared<ShapeMesh>(std::move(mesh))};
  }
  return GltfGeometry{.kind = GltfGeometry::hull, .points = std::move(hull)};
}

// The meshes of a node and of all below it, in the node's own frame.
std::optional<GltfGeometry> node_geometry(GltfDocument& document, const JsonPlace& geometry) {
  const auto top = geometry["node"].index();
  if (!top || *top >= document.nodes().size()) {
    document.refuse(geometry["node"].wrong("the number of a node of the file"));
    return {};
  }
  ShapeMesh mesh;
  std::vector<std::pair<std::size_t, Affine>> open{{*top, Affine{}}};
  for (std::size_t visited = 0; !open.empty() && visited <= document.nodes().size(); ++visited) {
    const auto [number, map] = open.back();
    open.pop_back();
    const GltfNode& node = document.nodes()[number];
    if (node.field["skin"].present()) document.notes.add("skins of meshes are not used for their collisions");
    const JsonPlace own = document.element(node.field["mesh"], document.root()["meshes"]);
    if (own.present()) add_mesh(document, own, map, mesh);
    for (const std::size_t child : node.children) open.emplace_back(child, map * document.nodes()[child].local);
    if (mesh.points_m.size() > 4 * kMaxMeshPoints) break;
  }
  return made_of(document, mesh, document.flag(geometry["convexHull"], false), geometry["node"]);
}

std::optional<GltfGeometry> implicit(GltfDocument& document, const JsonPlace& shape) {
  const std::string type = shape["type"].text_or("");
  const JsonPlace own = shape[type];
  if (type == "mesh") {  // in earlier drafts
    ShapeMesh triangles;
    const JsonPlace mesh = document.element(own["mesh"], document.root()["meshes"]);
    if (mesh.present()) add_mesh(document, mesh, {}, triangles);
    const JsonPlace hull = shape["extensions"]["KHR_physics_rigid_bodies"]["convexHull"];
    return made_of(document, triangles, document.flag(hull, false), own["mesh"]);
  }
  const auto size = [&document](const JsonPlace& field, double fallback, bool may_be_0 = false) {
    const double value = document.number(field, fallback);
    if (!(value >= 0 && value <= range::kSize_m.high && (may_be_0 || value > 0)))
      document.refuse(field.wrong(may_be_0 ? "from 0 to 1000 m" : "above 0, at most 1000 m"));
    return value;
  };
  GltfGeometry geometry;
  if (type == "box") {
    geometry.size_m = {size(own["size"][0], 1), size(own["size"][1], 1), size(own["size"][2], 1)};
    return geometry;
  }
  if (type == "sphere") {
    geometry.kind = GltfGeometry::sphere;
    geometry.radius_m = size(own["radius"], 0.5);
    return geometry;
  }
  if (type == "plane") {
    geometry.kind = GltfGeometry::plane;
    geometry.double_sided = document.flag(own["doubleSided"], false);
    const bool ends = own["sizeX"].present() || own["sizeZ"].present();
    if (ends) geometry.size_m = {size(own["sizeX"], 1000), 0, size(own["sizeZ"], 1000)};
    if (geometry.double_sided && !ends)
      document.notes.add("a double-sided plane without ends is a sheet of 1000 m by 1000 m");
    return geometry;
  }
  if (type != "cylinder" && type != "capsule") {
    document.notes.add("a shape of type '" + type + "' is not known; colliders of that shape are left out");
    return {};
  }
  const double height_m = size(own["height"], 0.5);
  const double bottom_m = size(own["radiusBottom"], 0.25, true);
  const double top_m = size(own["radiusTop"], 0.25, true);
  if (!(bottom_m + top_m > 0)) document.refuse(own.wrong("a radius above 0 at one of its ends"));
  if (!document.result()) return {};
  geometry.kind = GltfGeometry::hull;
  geometry.points =
      hull_of(type == "cylinder" ? cylinder(height_m, bottom_m, top_m) : capsule(height_m, bottom_m, top_m));
  if (!geometry.points) document.refuse(own.wrong("a body, neither too flat nor too thin"));
  return geometry.points ? std::optional(geometry) : std::nullopt;
}

// Returns the factors along the axes if the map only stretches along the axes and shifts; otherwise nothing.
std::optional<Vec3> stretch(const Matrix3& m) {
  const Vec3 along{std::abs(m[0][0]), std::abs(m[1][1]), std::abs(m[2][2])};
  const double min = 1e-9 * std::max({along.x, along.y, along.z});
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (i != j && std::abs(m[i][j]) > min) return {};
    }
  }
  return along;
}

Vec3 times(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

Shape mesh_shape(ShapeMesh mesh, ShapeType type) {
  Shape shape{.type = type};
  shape.mesh = std::make_shared<const ShapeMesh>(std::move(mesh));
  return shape;
}

// A hull from one whose corners were moved by a linear map, which keeps it a hull.
Shape hull_shape(const ShapeMesh& hull, const Affine& map) { return mesh_shape(moved(hull, map), ShapeType::convex); }

}  // namespace

ShapeMesh mesh_of(const Shape& shape) {
  if (shape.mesh) return *shape.mesh;
  const Affine shift{.shift_m = shape.center_m.value_or(Vec3{})};
  if (shape.type == ShapeType::box) return moved(box_mesh(shape.size_m), shift);
  const auto hull = hull_of(ball(shape.radius_m));
  return moved(hull ? *hull : box_mesh(2 * shape.radius_m * Vec3{1, 1, 1}), shift);
}

JsonPlace geometry_of(const JsonPlace& collider) {
  return collider["geometry"].present() || !collider["shape"].present() ? collider["geometry"] : collider;
}

JsonPlace shapes_of(const JsonPlace& root) {
  const JsonPlace extensions = root["extensions"];
  const JsonPlace shapes = extensions["KHR_implicit_shapes"]["shapes"];
  return shapes.present() ? shapes : extensions["KHR_collision_shapes"]["shapes"];
}

std::optional<GltfGeometry> read_geometry(GltfDocument& document, const JsonPlace& geometry) {
  if (geometry["node"].present()) return node_geometry(document, geometry);
  if (!geometry["shape"].present()) {
    document.refuse(geometry.wrong("an object with a shape or a node"));
    return {};
  }
  const JsonPlace shape = document.element(geometry["shape"], shapes_of(document.root()));
  return shape.present() ? implicit(document, shape) : std::nullopt;
}

std::optional<Shape> place(const GltfGeometry& geometry, const Affine& map) {
  const Parts parts = parts_of(map.linear);
  if (!(std::min({parts.scale.x, parts.scale.y, parts.scale.z}) > 0)) return {};
  Shape shape;
  shape.center_m = map.shift_m;
  switch (geometry.kind) {
    case GltfGeometry::box:
      if (const auto along = stretch(map.linear)) {
        shape.size_m = times(*along, geometry.size_m);
        return shape;
      }
      return mesh_shape(moved(box_mesh(geometry.size_m), map), ShapeType::convex);
    case GltfGeometry::sphere: {
      const Vec3 s = parts.scale;
      const bool even = !parts.sheared && std::max({s.x, s.y, s.z}) - std::min({s.x, s.y, s.z}) < 1e-6 * s.x;
      if (!even) {
        const auto hull = hull_of(ball(geometry.radius_m));
        return hull ? std::optional(hull_shape(*hull, map)) : std::nullopt;
      }
      shape.type = ShapeType::sphere;
      shape.radius_m = s.x * geometry.radius_m;
      return shape;
    }
    case GltfGeometry::hull:
      return hull_shape(*geometry.points, map);
    case GltfGeometry::mesh:
      return mesh_shape(moved(*geometry.points, map), ShapeType::trimesh);
    case GltfGeometry::plane:
      break;
  }
  if (geometry.size_m == Vec3{}) return {};
  if (geometry.double_sided) {
    const double sheet_m = kSheet_m / std::max(parts.scale.y, 1e-9);  // whatever the node's scale
    return place({.size_m = {geometry.size_m.x, sheet_m, geometry.size_m.z}}, map);
  }
  const double thick_m = std::max(kPlaneThickness * std::min(geometry.size_m.x, geometry.size_m.z), kThinnest_m);
  GltfGeometry slab{.size_m = {geometry.size_m.x, thick_m, geometry.size_m.z}};
  return place(slab, map * Affine{.shift_m = {0, -0.5 * thick_m, 0}});
}

StaticDescription place_plane(const GltfGeometry& geometry, const Affine& map) {
  if (geometry.double_sided) {
    return {.type = StaticType::box,
            .size_m = {range::kSize_m.high, kSheet_m, range::kSize_m.high},
            .position_m = map.shift_m,
            .rotation = parts_of(map.linear).rotation};
  }
  const auto column = [&map](int k) { return Vec3{map.linear[0][k], map.linear[1][k], map.linear[2][k]}; };
  const Vec3 across = cross(column(2), column(0));
  const double up = dot(across, column(1)) < 0 ? -1 : 1;
  StaticDescription plane;
  if (length(across) > 0) plane.normal = (up / length(across)) * across;
  plane.offset_m = dot(plane.normal, map.shift_m);
  return plane;
}

ShapeMesh surface_of(GltfDocument& document, std::span<const std::size_t> nodes, const Affine& map) {
  ShapeMesh all;
  for (const std::size_t number : nodes) {
    const GltfNode& node = document.nodes()[number];
    const JsonPlace mesh = document.element(node.field["mesh"], document.root()["meshes"]);
    if (mesh.present()) add_mesh(document, mesh, map * node.world, all);
  }
  return welded(all);
}

Shape join(std::span<const Shape> shapes) {
  if (shapes.size() == 1) return shapes[0];
  ShapeMesh all;
  for (const Shape& shape : shapes) append(all, mesh_of(shape));
  return mesh_shape(std::move(all), ShapeType::trimesh);
}

// The cyclic Jacobi method (Golub and Van Loan, 8.5): each turn makes one pair of off-diagonal elements zero.
void set_inertia(modal::MassProperties& mass, const Matrix3& tensor) {
  constexpr int kMaxSweeps = 30;
  Matrix3 a = tensor;
  Rotation axes;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    const double off = std::abs(a[0][1]) + std::abs(a[0][2]) + std::abs(a[1][2]);
    if (!(off > 1e-16 * (a[0][0] + a[1][1] + a[2][2]))) break;
    for (const auto& [i, j, k] : {std::array{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}) {
      const double angle = 0.5 * std::atan2(2 * a[i][j], a[i][i] - a[j][j]);
      const Rotation turn = about({k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0}, angle);
      const Matrix3 r = to_matrix(turn);
      a = product(product(transpose(r), a), r);
      axes = normalized(axes * turn);
    }
  }
  mass.inertia_kg_m2 = {a[0][0], a[1][1], a[2][2]};
  mass.orientation = {axes.x, axes.y, axes.z, axes.w};
}

// A mesh's volume and its first and second moments are sums over the tetrahedra made of its triangles and the origin.
// With corners a, b, c and s = a + b + c, a tetrahedron has V = a . (b x c) / 6, the first moment V s / 4 and the
// second moments V (s s^T + a a^T + b b^T + c c^T) / 20.
modal::MassProperties mass_of(const Shape& shape, double density_kg_m3) {
  ShapeMesh mesh = mesh_of(shape);
  if (mesh.triangles.empty()) {
    if (const auto hull = hull_of(mesh)) mesh = *hull;
  }
  const auto sums = [](const ShapeMesh& of) {
    double volume = 0;
    Vec3 first;
    Matrix3 second{};
    for (const auto& [i, j, k] : of.triangles) {
      const Vec3 a = of.points_m[i], b = of.points_m[j], c = of.points_m[k], s = a + b + c;
      const double v = dot(a, cross(b, c)) / 6;
      volume += v;
      first = first + (v / 4) * s;
      for (const Vec3 p : {s, a, b, c}) {
        const std::array q{p.x, p.y, p.z};
        for (int row = 0; row < 3; ++row) {
          for (int col = 0; col < 3; ++col) second[row][col] += v / 20 * q[row] * q[col];
        }
      }
    }
    return std::tuple(volume, first, second);
  };
  auto [volume, first, second] = sums(mesh);
  Vec3 low = mesh.points_m.front(), high = low;
  for (const Vec3& p : mesh.points_m) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 size{std::max(high.x - low.x, kThinnest_m), std::max(high.y - low.y, kThinnest_m),
                  std::max(high.z - low.z, kThinnest_m)};
  if (!(std::abs(volume) > 1e-4 * size.x * size.y * size.z)) {
    std::tie(volume, first, second) = sums(moved(box_mesh(size), {.shift_m = 0.5 * (low + high)}));
  }
  modal::MassProperties mass;
  mass.mass_kg = density_kg_m3 * std::abs(volume);
  const Vec3 center = (1 / volume) * first;
  mass.center_of_mass_m = center;
  if (shape.type == ShapeType::sphere && !shape.mesh) {
    mass.mass_kg = density_kg_m3 * 4 / 3 * std::numbers::pi * std::pow(shape.radius_m, 3);
    mass.center_of_mass_m = shape.center_m.value_or(Vec3{});
    mass.inertia_kg_m2 = 0.4 * mass.mass_kg * shape.radius_m * shape.radius_m * Vec3{1, 1, 1};
    return mass;
  }
  const double sign = volume < 0 ? -1 : 1;
  const std::array c{center.x, center.y, center.z};
  Matrix3 tensor{};
  double trace = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      tensor[i][j] = -density_kg_m3 * sign *
                     (second[i][j] - volume * c[static_cast<std::size_t>(i)] * c[static_cast<std::size_t>(j)]);
    trace -= tensor[i][i];
  }
  for (int i = 0; i < 3; ++i) tensor[i][i] += trace;
  set_inertia(mass, tensor);
  return mass;
}

}  // namespace ringdown::scene
