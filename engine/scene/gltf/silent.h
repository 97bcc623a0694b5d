// The bodies of a glTF scene that have an acoustic material and no modal model, for programs that bake them. [worker]
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

// An acoustic material of the file. Members that the file does not state are empty.
struct GltfMaterial {
  std::size_t number = 0;  // in acousticMaterials
  std::string name;
  std::optional<double> density_kg_m3, young_pa, poisson, alpha_per_s, beta_s;
};

// A body as a solid, in the frame of `node` but in metres: its points are the node's own times `scale`.
struct SilentBody {
  std::size_t node = 0;  // that is to play the model: of the motion, or of a collider without one
  std::string name;
  double scale = 1;               // of the node in the scene, the same along all axes
  ShapeMesh surface;              // of its meshes, or of a collider's; no triangles: see `geo`
  std::string geo;                // a .geo text of its implicit shapes, where it has no mesh, in metres
  GltfMaterial material;          // of the acoustic surface of its first collider that has one, else of its node
  std::optional<double> mass_kg;  // that the file gives it
  std::string trouble;            // a sentence why it cannot be baked, else empty
};

struct SilentBodies {
  std::vector<SilentBody> bodies;  // in the order of their nodes
  std::vector<std::string> notes;  // about what its meshes have and a bake leaves out
};

// Finds them in the scene that is played. Fails on files that a reader of scenes refuses (gltf/scene.h).
Result<SilentBodies> find_silent_bodies(const modal::Glb& glb);

}  // namespace ringdown::scene
