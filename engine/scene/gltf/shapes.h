// Converts colliders of a glTF scene to our shapes: implicit shapes (KHR_implicit_shapes) and the meshes of nodes.
// [worker]
//
// A box and a sphere are kept if their node's scale allows. A cylinder, a cone, a capsule, and a sphere under an uneven
// scale become hulls with corners on the true surface. Several colliders of one body become one mesh.
#pragma once

#include "engine/scene/description.h"
#include "engine/scene/gltf/document.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

namespace ringdown::scene {

// Maximum number of points of all meshes of a scene together.
inline constexpr std::size_t kMaxScenePoints = std::size_t{1} << 20;

// A collider's geometry in its node's own frame.
struct GltfGeometry {
  enum Kind { box, sphere, hull, mesh, plane };
  Kind kind = box;
  Vec3 size_m;                              // box; plane: its extent along x and z, 0 if infinite
  double radius_m = 0;                      // sphere
  bool double_sided = false;                // plane: if true, a sheet 2 mm thick about the plane; if false, solid below
  std::shared_ptr<const ShapeMesh> points;  // hull, mesh
};

// Returns a collider's `geometry`. In earlier drafts, which Blender's exporter writes, the collider itself names the
// shape and is returned.
modal::JsonPlace geometry_of(const modal::JsonPlace& collider);

// Returns the shapes of the file with this root, under the extension's present name or its former one,
// KHR_collision_shapes.
modal::JsonPlace shapes_of(const modal::JsonPlace& root);

// Reads a `geometry` object. Returns nothing, with a note in the document, if it is not supported or disabled.
std::optional<GltfGeometry> read_geometry(GltfDocument& document, const modal::JsonPlace& geometry);

// Returns the geometry as a shape in a body's frame. `map` takes the node's frame into the body's. Returns nothing for
// an infinite plane, and if a scale of 0 disables the shape.
std::optional<Shape> place(const GltfGeometry& geometry, const Affine& map);

// Returns an infinite plane as a static: a half-space, or a sheet if it is double-sided. `map` takes the node's frame
// into the world.
StaticDescription place_plane(const GltfGeometry& geometry, const Affine& map);

// Returns the meshes of the nodes (not of nodes below them) as one mesh. Each node's points are transformed by its pose
// in the world and then by `map`; corners in one place are joined.
ShapeMesh surface_of(GltfDocument& document, std::span<const std::size_t> nodes, const Affine& map);

// Returns the surface of a shape that is a box or a sphere with a size or has a mesh. A sphere becomes a hull.
ShapeMesh mesh_of(const Shape& shape);

// Joins several shapes of one body into one mesh.
Shape join(std::span<const Shape> shapes);

// Returns the mass of a solid of this shape, which is a box or a sphere with a size or has a mesh. A mesh that encloses
// no volume gets the mass of its bounding box.
modal::MassProperties mass_of(const Shape& shape, double density_kg_m3);

// Sets the principal moments and axes from a symmetric tensor.
void set_inertia(modal::MassProperties& mass, const Matrix3& tensor);

}  // namespace ringdown::scene
