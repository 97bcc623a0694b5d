// Tetrahedra from decks of Abaqus and CalculiX (.inp). [any thread]
//
// Read are *NODE and *ELEMENT up to the first *STEP, in any order and any number of blocks:
//   *NODE       number, x, y, z; what is missing is 0. Numbers are positive, in any order, with gaps.
//   *ELEMENT    of type C3D4 or C3D10 and their variants (C3D10M, C3D4H, DC3D10 ...), one order in a file. A line that
//               ends with a comma goes on in the next. Shells, beams, springs and other elements without a volume of
//               their own are passed over; other solids are refused.
//   *PART       one, with one *INSTANCE that is not moved. What stands in *ASSEMBLY beside it is no part of the body.
// Sets, materials and whatever else is passed over. Refused is what would place nodes that the file does not list:
// *INCLUDE and INPUT=, *NGEN, *ELGEN and the like, *SYSTEM, cylindrical and spherical coordinates.
//
// A keyword may be in any case and hold blanks; lines that begin with ** are comments.
//
// Memory is in proportion to the text. Errors are one sentence with the line, and what is wrong there. Like all of
// tet_file.h this checks nothing but the file itself.
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"

#include <string>
#include <string_view>

namespace ringdown::mesh {

// `name` stands in the sentences.
Result<TetMesh> read_inp(std::string_view text, const std::string& name);

}  // namespace ringdown::mesh
