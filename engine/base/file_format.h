// The file formats that Ringdown knows, by the endings of file names. The table in file_format.cpp is the only place
// that gives endings a meaning; case is ignored. [any thread]
//
// A new mesh format needs one row in file_format.cpp and a reader in engine/mesh.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace ringdown {

enum class FileKind {
  surface,     // triangles
  gltf,        // triangles, a bank or a scene
  tetrahedra,  // elements, read by our own readers
  gmsh_mesh,   // elements, read by gmsh
  geometry,    // a body that gmsh meshes
  program,     // a body in gmsh's language, with parameters; may contain elements
  table,       // TOML: objects, scenes, materials, notes, states
  sound,
};

struct FileFormat {
  std::string_view ending;  // in lower case, with its dot
  FileKind kind;
  // The length unit [m] that the format prescribes.
  double unit_m = 1;
  // True: gmsh recognises the ending. False: gmsh would read the file as a program in its own language.
  bool known_to_gmsh = false;
  // True: when a folder is baked, each file with this ending is a body.
  bool is_body = true;
  // True: a body may need further files beside the named one.
  bool has_companions = false;
};

// Returns null if the table lacks the ending or the name has none.
const FileFormat* format_of(const std::filesystem::path& path);

bool is_of_kind(const std::filesystem::path& path, FileKind kind);

// Returns the name's ending in lower case, with its dot; empty if there is none.
std::string ending_of(const std::filesystem::path& path);

// `ending` must be in lower case, with its dot.
bool has_ending(const std::filesystem::path& path, std::string_view ending);

// Returns the endings of all bodies, for messages: ".obj .stl ... (surfaces), .step ... (geometries), .msh ...
// (meshes)".
std::string endings_of_bodies();

}  // namespace ringdown
