// Reads scenes from glTF files with KHR_physics_rigid_bodies, KHR_implicit_shapes and KHR_audio_rigid_bodies, which
// other programs write (docs/use/gltf-scenes.md). [worker]
//
// Every node with a motion becomes a body, with the colliders below the node. Every other collider becomes a fixed
// body, and an infinite plane becomes a static. Every node that plays a modal model becomes an object, whose bank is
// that model of the file ("room.glb#2", engine/modal/bank_file.h). The scene is converted to z up. A body's frame is
// that of its node with the model, so the mesh keeps its coordinates of the file.
#pragma once

#include "engine/base/result.h"
#include "engine/gltf/read_beside.h"
#include "engine/scene/description.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace ringdown::scene {

struct GltfScene {
  SceneDescription scene;
  std::vector<std::string> notes;  // sentences about parts of the file that the scene lacks, each listed once
};

// Returns a hash of everything that a description says, wherever its file is. A file written by Ringdown
// (gltf/writer.h) stores the hash of the part that all programs understand. While the file still matches, Ringdown
// plays its own, more detailed scene stored inside instead.
std::string fingerprint(const SceneDescription& scene);

// Returns whether a path names a glTF file, by its ending.
bool is_gltf(const std::filesystem::path& path);

// Reads a scene from the bytes of a .glb or a .gltf file. `path` appears in errors and is the path of the banks in the
// file. Everything in the file is checked first, as for banks (engine/gltf/glb.h).
//
// With limits for `foley`, the contacts of animated bodies are recovered from their motion: meshes without physics are
// bodies, too (gltf/mesh_bodies.h), animations play once at the frames of the file, and the scene is as long as they.
//
// The camera of the name `camera`, by default the first, is the listener and goes where the animations take it.
Result<GltfScene> parse_gltf_scene(std::span<const std::byte> bytes, const std::filesystem::path& path,
                                   const modal::ReadBeside& read_beside, const std::optional<FoleyLimits>& foley = {},
                                   const std::optional<std::string>& camera = {});

}  // namespace ringdown::scene
