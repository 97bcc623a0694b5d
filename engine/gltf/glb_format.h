// Numbers and names of glTF 2.0 and of EXT_meshopt_compression, for glb.cpp and glb_arrays.cpp. [any thread]
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace ringdown::modal {

inline constexpr std::uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

// Component types of accessors.
inline constexpr std::size_t kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123,
                             kUnsignedInt = 5125, kFloat = 5126;

inline constexpr const char* kMeshopt = "EXT_meshopt_compression";
// Names in the order of MeshoptMode and MeshoptFilter.
inline constexpr std::array kMeshoptModes = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
inline constexpr std::array kMeshoptFilters = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};

}  // namespace ringdown::modal
