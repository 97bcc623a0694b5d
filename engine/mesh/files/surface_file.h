// Surfaces from files. [any thread]
//
//   .obj .stl .ply .off   text or binary (surface_formats.h); their lengths have no unit
//   .gltf .glb            metres (gltf_mesh.h). A bank is one of these
//
// Polygons are cut into triangles, all meshes of a file become one, and points that a file repeats, as STL does for
// every triangle, become one: those within kWeld of the diagonal of the body's box. No other file is opened than those
// that glTF keeps its numbers in, in its folder.
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/files/file_kinds.h"
#include "engine/mesh/triangle_mesh.h"

#include <filesystem>
#include <string>
#include <vector>

namespace ringdown::mesh {

inline constexpr double kWeld = 1e-6;
inline constexpr std::size_t kMaxTriangles = 4'000'000;
inline constexpr std::size_t kMaxSurfaceFileBytes = std::size_t{1} << 30;  // bytes

// In the file's unit. Fails with one sentence: it is no such file, has no triangles, more than kMaxTriangles, or a
// coordinate that is not finite.
// `notes` receives what was read otherwise than the file says, and what its numbers are too coarse for.
Result<TriangleMesh> read_surface(const std::filesystem::path& path, std::vector<std::string>* notes = nullptr);

// Points within `tolerance` of an earlier one become that one, and points of no triangle are dropped. Triangles stay,
// also those that so become degenerate. O(V).
TriangleMesh weld(const TriangleMesh& mesh, double tolerance);

}  // namespace ringdown::mesh
