// The triangles of a glTF file, as a viewer shows them before anything moves. [any thread]
//
//   - The nodes of the scene, at their places; of a file without scenes all nodes, without nodes all meshes.
//   - Skinned meshes as their joints place them, wherever their own nodes are.
//   - Morph targets with the weights that the node or its mesh has.
//   - Lists, strips and fans of triangles; points and lines are left out.
//   - Accessors of any type, sparse, quantized (KHR_mesh_quantization) or compressed (EXT_meshopt_compression).
//
// Buffers are inside the file, or in files of its folder and below.
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/files/triangle_soup.h"

#include <cstddef>
#include <filesystem>
#include <string_view>

namespace ringdown::mesh {

// In metres, with the axes of the file. `content` is that of the file at `path`. Fails with one sentence: on an
// extension that is required and not read, on more than `max_triangles`, and on what contradicts itself.
Result<TriangleSoup> read_gltf_mesh(std::string_view content, const std::filesystem::path& path,
                                    std::size_t max_triangles);

}  // namespace ringdown::mesh
