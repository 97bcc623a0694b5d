// Tetrahedra from files that gmsh does not read. [any thread]
//
//   TetGen   x.node and x.ele; naming either finds the other. Numbered from 0 or 1, 4 or 10 nodes to an element;
//            attributes, boundary markers and comments (#) are passed over. Nodes 5 to 10 may come in any order.
//   Vega     x.veg with *VERTICES and *ELEMENTS of type TET, numbered from 0 or 1; *MATERIAL and the like are passed
//            over. *INCLUDE is refused: name the file that holds the mesh.
//   Abaqus   x.inp, also CalculiX's (inp_file.h).
//   IsoStuffer's binary .tet (Zheng & James's ModalSound): little-endian
//            int32 nodes held fixed (0 from IsoStuffer), int32 free nodes, 3 doubles for each node, the fixed ones
//            first, int32 elements, 4 int32 for each element, nodes numbered from 0.
//            The first count may be missing, as in the older form without fixed nodes. What is held is let go.
//
// Lengths are taken as they stand; scale them afterwards. Nothing is checked beyond the file itself: elements may be
// inside out, overlap or be flat (mesh::check_mesh).
//
// The counts in a file are compared with the file's size before memory is allocated. Errors are one sentence with the
// line, or the byte, and what is wrong there.
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace ringdown::mesh {

// A file of FileKind::tetrahedra (engine/base/file_format.h).
Result<TetMesh> read_tet_file(const std::filesystem::path& path);

// Read the mesh from the content of the files. `name` stands in the sentences.
Result<TetMesh> read_tetgen(std::string_view node_text, std::string_view ele_text, const std::string& name);
Result<TetMesh> read_vega(std::string_view text, const std::string& name);
Result<TetMesh> read_isostuffer(std::span<const std::byte> file, const std::string& name);

}  // namespace ringdown::mesh
