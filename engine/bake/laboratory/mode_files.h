// Writes a body's mesh and its modes at all nodes, for programs of other people. [worker]
//
//   .vtu         VTK's XML: ParaView shows the mesh, and each mode as a vector field
//   .unv, .uff   Universal File Format: datasets 2411 (nodes), 2412 (elements) and 55 (modes), for modal analysis
//   .npz         numpy arrays, doubles: nodes_m N x 3, elements E x n, frequencies_hz, undamped_hz and decays_per_s M,
//                shapes M x N x 3 [kg^-1/2]
//
// VTK and UFF get elements of higher order as linear tetrahedra between all of their nodes, p^3 for each, so that any
// program shows them; .npz has the elements themselves (mesh/tet_element.h has the order of their nodes). Modes stand
// in the bank's order, with the bank's signs.
#pragma once

#include "engine/bake/bake.h"
#include "engine/base/result.h"

#include <filesystem>
#include <string>

namespace ringdown::bake {

// Fails for another ending; the sentence names those that are known.
Result<void> check_mode_file(const std::filesystem::path& path);

// `baked` has a body (options.interior). Fails as output_file.h does, and if an .npz would be larger than 4 GB.
Result<void> write_modes(const Baked& baked, const std::filesystem::path& path);

// Linear tetrahedra between all nodes of the elements, of positive volume where the elements are.
mesh::Indices linear_parts(const mesh::TetMesh& mesh);

}  // namespace ringdown::bake
