// The bodies of an animated glTF file without physics, as programs for pictures export it: every mesh that an animation
// moves, and every mesh that stands still. [worker]
#pragma once

#include "engine/scene/description.h"
#include "engine/scene/gltf/document.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::scene {

struct MeshBody {
  std::size_t node = 0;             // the node that an animation moves; of what stands still, that of the mesh
  std::vector<std::size_t> meshes;  // the nodes of the meshes that move with it
  std::string material;             // the name of the first ordinary material of these meshes; empty: none has a name
};

// Finds the meshes of the scene that is played, by the nodes of a document, and of which neither the node nor a node
// above it has a motion or a collider. Meshes below one animated node are one body, unless another animated node lies
// between. A file without animations has none.
std::vector<MeshBody> mesh_bodies(const modal::JsonPlace& root, const std::vector<GltfNode>& nodes);

// Returns the shape of meshes for collisions, in the frame that `map` leads to from the world. A closed mesh that fills
// most of its hull becomes the hull; a flat one becomes a slab below it; any other mesh stays as it is. Returns
// nothing, with a note in the document, without triangles or with too many points.
std::optional<Shape> shape_of_meshes(GltfDocument& document, const MeshBody& body, const Affine& map);

}  // namespace ringdown::scene
