// The formats that Ringdown knows, by the endings of file names. This table is the only place where an ending means
// something; capital and small letters are alike. [any thread]
//
// A new format of meshes takes one row in file_format.cpp, and its reader in engine/mesh.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace ringdown {

enum class FileKind {
  surface,     // triangles
  gltf,        // triangles, too; or a bank, or a scene
  tetrahedra,  // elements, from our own readers
  gmsh_mesh,   // elements, from gmsh's
  geometry,    // a body that gmsh meshes
  program,     // a body in gmsh's language, which takes parameters; it may hold elements
  table,       // TOML: objects, scenes, materials, notes, states
  sound,
};

struct FileFormat {
  std::string_view ending;  // in small letters, with its point
  FileKind kind;
  // The length of a file's unit [m] by its format alone.
  double unit_m = 1;
  // gmsh reads the file by its ending, and does not take it for its language.
  bool known_to_gmsh = false;
  // A folder's files of this ending are bodies to bake, each by itself.
  bool is_body = true;
  // A body may lie in further files beside the named one.
  bool has_companions = false;
};

// Returns null for an ending that the table lacks, and for none.
const FileFormat* format_of(const std::filesystem::path& path);

bool is_of_kind(const std::filesystem::path& path, FileKind kind);

// The name's ending in small letters, with its point; empty when there is none.
std::string ending_of(const std::filesystem::path& path);

// `ending` is in small letters, with its point.
bool has_ending(const std::filesystem::path& path, std::string_view ending);

// The endings of all bodies, for sentences: ".obj .stl ... (surfaces), .step ... (geometries), .msh ... (meshes)".
std::string endings_of_bodies();

}  // namespace ringdown
