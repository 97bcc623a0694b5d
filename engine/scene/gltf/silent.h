// Finds the bodies of a glTF scene that have an acoustic material but no modal model, for programs that bake such
// bodies. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/gltf/glb.h"
#include "engine/modal/bank.h"
#include "engine/scene/description.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::scene {

// A material of the file: an acoustic one, or, for a mesh without physics in an animated file, the name of an ordinary
// one. Members that the file does not state are empty.
struct GltfMaterial {
  std::optional<std::size_t> number;  // index in acousticMaterials; none: an ordinary material
  std::string name;
  std::optional<double> density_kg_m3, young_pa, poisson, alpha_per_s, beta_s;
};

// A body as a solid, along the axes of `node` but in metres: the node's own points times `scale`.
struct SilentBody {
  std::size_t node = 0;  // node that should play the model: the node of the motion, or of a collider without motion
  std::string name;
  double scale = 1;               // scale of the node in the scene, equal along all axes
  ShapeMesh surface;              // surface of its meshes or of a collider's; without triangles: see `geo`
  std::string geo;                // if there is no mesh: .geo text of its implicit shapes, in metres
  GltfMaterial material;          // from the acoustic surface of the first collider that has one, else of the node
  std::optional<double> mass_kg;  // mass stated in the file
  std::string trouble;            // a sentence why the body cannot be baked; empty if it can
};

struct SilentBodies {
  std::vector<SilentBody> bodies;  // in order of their nodes
  std::vector<std::string> notes;  // about parts of meshes that a bake leaves out
};

// Returns whether a file's animations move meshes without physics, whose ordinary materials then tell what they are of.
bool has_mesh_bodies(const modal::Glb& glb);

// Finds the silent bodies of the scene that is played. Fails on files that the reader of scenes refuses (gltf/scene.h).
Result<SilentBodies> find_silent_bodies(const modal::Glb& glb);

}  // namespace ringdown::scene
