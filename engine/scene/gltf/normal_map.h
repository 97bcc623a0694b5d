// Converts a normal map to the relief that a contact travels over. [worker]
//
// The map is read along its rows, in the direction of growing u, one row after the other, like a helix around the
// texture. The slope is that of the normal, -x / z; the length of a texel follows from the texture coordinates of the
// mesh. The relief scales with the mesh, as the picture does.
#pragma once

#include "engine/base/result.h"
#include "engine/gltf/read_beside.h"
#include "engine/modal/surface_relief.h"
#include "engine/scene/gltf/document.h"

#include <optional>

namespace ringdown::scene {

inline constexpr std::size_t kMaxMaps = 64;                          // one per combination of surface, mesh and size
inline constexpr std::size_t kMaxMapBytes = std::size_t{1} << 26;    // size of the picture file
inline constexpr std::size_t kMaxMapPixels = std::size_t{1} << 24;   // pixels of the unpacked picture
inline constexpr std::size_t kMaxMapSamples = std::size_t{1} << 18;  // samples of the relief; limits the rows read

// Returns the relief of the mesh's first primitive that has one. `own` is the surface's normalTexture; if present, it
// replaces that of the primitive's material. `map` takes the mesh into the world. Returns nothing if there is no map,
// and, with a note, if the map cannot be used: a picture other than PNG, no texture coordinates, no size, one texel, or
// kMaxMaps read already.
std::optional<modal::SurfaceTrack> relief_of(GltfDocument& document, const modal::JsonPlace& own,
                                             const modal::JsonPlace& mesh, const Affine& map, bool may_read,
                                             const modal::ReadBeside& read_beside);

}  // namespace ringdown::scene
