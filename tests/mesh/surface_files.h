// Surfaces as files, written byte by byte from the formats' descriptions.
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <string>

namespace ringdown::test {

// What a file with that ending holds: ".obj", ".stl" (binary),
// "ascii.stl", ".ply" (binary), "ascii.ply", ".off", ".glb". `scale` divides the coordinates: 0.001 for a file in
// millimetres. A .glb has the scale in its node instead.
std::string file_of(const mesh::TriangleMesh& mesh, const std::string& ending, double scale = 1);

}  // namespace ringdown::test
