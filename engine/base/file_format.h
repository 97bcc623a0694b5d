// The formats that Ringdown knows, by the endings of file names. This table is the only place where an ending means
// something; capital and small letters are alike. [any thread]
//
// A new format of meshes takes one row in file_format.cpp. One that gmsh does not read takes a reader, too, with its
// row in engine/mesh/files/surface_formats.h (triangles) or tet_file.cpp (tetrahedra).
#pragma once

#include <array>
#include <filesystem>
#include <initializer_list>
#include <span>
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

// Where the rest of a body lies that is in more files than the named one.
enum class Companions {
  none,
  siblings,  // in files of the same name with other endings
  uris,      // in files that its JSON names
  includes,  // in files that its text includes
};

struct FileFormat {
  std::string_view ending;  // in small letters, with its point
  FileKind kind;
  // The length of a file's unit [m] by its format alone.
  double unit_m = 1;
  // gmsh reads the file by its ending, and does not take it for its language.
  bool known_to_gmsh = false;
  // OpenCASCADE's name of the format, by which gmsh imports the file; empty where gmsh opens the file by itself.
  std::string_view opencascade = "";
  // A folder's files of this ending are bodies to bake, each by itself.
  bool is_body = true;
  // Help texts, which name a few formats only, name this one.
  bool example = false;
  Companions companions = Companions::none;
  std::array<std::string_view, 2> siblings = {};  // their endings
};

std::span<const FileFormat> file_formats();

// Returns null for an ending that the table lacks, and for none.
const FileFormat* format_of(const std::filesystem::path& path);

bool is_of_kind(const std::filesystem::path& path, FileKind kind);

// The name's ending in small letters, with its point; empty when there is none.
std::string ending_of(const std::filesystem::path& path);

// `ending` is in small letters, with its point.
bool has_ending(const std::filesystem::path& path, std::string_view ending);

// The endings of all bodies, for sentences: ".obj .stl ... (surfaces), .step ... (geometries), .msh ... (meshes)".
std::string endings_of_bodies();

// The endings of the examples among these kinds, for help texts: ".geo .step .brep". One kind comes after the other.
std::string example_endings(std::initializer_list<FileKind> kinds);

}  // namespace ringdown
