// Colliders of a glTF scene as shapes of ours: implicit shapes (KHR_implicit_shapes) and the meshes of nodes. [worker]
//
// A box and a sphere stay what they are where their node's scale allows. A cylinder, a cone, a capsule, and a sphere
// under an uneven scale become hulls with corners on the true surface; several colliders of one body become one mesh.
#pragma once

#include "engine/scene/description.h"
#include "engine/scene/gltf/document.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

namespace ringdown::scene {

// The most points of all meshes of a scene together.
inline constexpr std::size_t kMaxScenePoints = std::size_t{1} << 20;

// A collider's geometry in its node's own frame.
struct GltfGeometry {
  enum Kind { box, sphere, hull, mesh, plane };
  Kind kind = box;
  Vec3 size_m;                              // box; plane: of its x and z, 0 where it has no end
  double radius_m = 0;                      // sphere
  bool double_sided = false;                // plane: a sheet 2 mm thick, its middle in the plane; else solid below
  std::shared_ptr<const ShapeMesh> points;  // hull, mesh
};

// A collider's `geometry`; of earlier drafts, which Blender's exporter writes, the collider itself, which names a
// shape.
modal::Field geometry_of(const modal::Field& collider);

// The shapes of the file with this root, by the extension's present name or its former one, KHR_collision_shapes.
modal::Field shapes_of(const modal::Field& root);

// Reads a `geometry` object. Nothing when it is not supported, or disabled, which the document's notes then say.
std::optional<GltfGeometry> read_geometry(GltfDocument& document, const modal::Field& geometry);

// The geometry as a shape in a body's frame, in which its node lies by `map`. Nothing for an infinite plane, and where
// a scale of 0 disables the shape.
std::optional<Shape> place(const GltfGeometry& geometry, const Affine& map);

// An infinite plane as a static, its node lying by `map` in the world: a half-space, or a sheet where it has two sides.
StaticDescription place_plane(const GltfGeometry& geometry, const Affine& map);

// The meshes of these nodes themselves as one, each node's points moved by its place in the world and then by `map`;
// corners in one place are joined.
ShapeMesh surface_of(GltfDocument& document, std::span<const std::size_t> nodes, const Affine& map);

// Several shapes of one body as one mesh.
Shape join(std::span<const Shape> shapes);

// The mass of a solid of this shape, which is a box or a sphere with a size or has a mesh. A mesh that encloses nothing
// has the mass of its bounding box.
modal::MassProperties mass_of(const Shape& shape, double density_kg_m3);

// Principal moments and axes of a symmetric tensor.
void set_inertia(modal::MassProperties& mass, const Matrix3& tensor);

}  // namespace ringdown::scene
