// Reads scenes from glTF files with KHR_physics_rigid_bodies, KHR_implicit_shapes and KHR_audio_rigid_bodies, which
// other programs write (docs/use/gltf-scenes.md). [worker]
//
// Every node with a motion becomes a body, with the colliders below it; every other collider becomes a fixed body, and
// an infinite plane a static. Every node that plays a modal model becomes an object, whose bank is that model of the
// file ("room.glb#2", engine/modal/bank_file.h). The scene's z points up, as ours does, and a body's frame is that of
// its node with the model, in which the mesh lies as in the file.
#pragma once

#include "engine/base/result.h"
#include "engine/gltf/read_beside.h"
#include "engine/scene/description.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace ringdown::scene {

struct GltfScene {
  SceneDescription scene;
  std::vector<std::string> notes;  // sentences about what the file has and the scene has not, each once
};

// A name for all that a description says, wherever its file is. A file that Ringdown wrote (gltf/writer.h) has the name
// of what it says to every program. As long as that is what the file says, Ringdown's own scene inside, which says
// more, is played in its place.
std::string fingerprint(const SceneDescription& scene);

// Whether a path names a glTF file, by its ending.
bool is_gltf(const std::filesystem::path& path);

// Reads a scene from the bytes of a .glb or a .gltf file. `path` stands in errors and is the path of its banks.
// Everything in the file is checked first, as for banks (engine/gltf/glb.h).
Result<GltfScene> parse_gltf_scene(std::span<const std::byte> bytes, const std::filesystem::path& path,
                                   const modal::ReadBeside& read_beside);

}  // namespace ringdown::scene
