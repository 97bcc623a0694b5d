// A normal map as the relief that a contact travels over. [worker]
//
// The map is read along its rows, in the direction in which u grows, one row after the other, as a helix around the
// texture: the slope there is that of the normal, -x / z, and the length of a texel follows from where the triangles of
// the mesh have their texture coordinates. The relief scales with the mesh, as the picture does.
#pragma once

#include "engine/base/result.h"
#include "engine/gltf/read_beside.h"
#include "engine/modal/surface_relief.h"
#include "engine/scene/gltf/document.h"

#include <optional>

namespace ringdown::scene {

inline constexpr std::size_t kMaxMaps = 64;                          // each for its surface, mesh and size
inline constexpr std::size_t kMaxMapBytes = std::size_t{1} << 26;    // of the picture file
inline constexpr std::size_t kMaxMapPixels = std::size_t{1} << 24;   // that it unpacks to
inline constexpr std::size_t kMaxMapSamples = std::size_t{1} << 18;  // of the relief: so many texels' rows are read

// The relief of the first primitive of a mesh that has one. `own` is the surface's normalTexture, which replaces the
// one of the primitive's material when it is present. `map` takes the mesh into the world. Nothing when there is no
// map, and when it cannot be used, which the notes then say: pictures other than PNG, no texture coordinates, no size,
// one texel. Nor is one read that may not be, because the scene has kMaxMaps already.
std::optional<modal::SurfaceTrack> relief_of(GltfDocument& document, const modal::Field& own, const modal::Field& mesh,
                                             const Affine& map, bool may_read, const modal::ReadBeside& read_beside);

}  // namespace ringdown::scene
