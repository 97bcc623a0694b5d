// The file formats that Ringdown knows, by the endings of file names. The table in file_format.cpp is the only place
// that gives endings a meaning; case is ignored. [any thread]
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
  gltf,        // triangles, a bank or a scene
  tetrahedra,  // elements, read by our own readers
  gmsh_mesh,   // elements, read by gmsh
  geometry,    // a body that gmsh meshes
  program,     // a body in gmsh's language, with parameters; may contain elements
  table,       // TOML: objects, scenes, materials, notes, states
  sound,
};

// The place of the rest of a body whose data are in more files than the named one.
enum class Companions {
  none,
  siblings,  // in files of the same name with other endings
  uris,      // in files that its JSON names
  includes,  // in files that its text includes
};

struct FileFormat {
  std::string_view ending;  // in lower case, with its dot
  FileKind kind;
  // The length unit [m] that the format prescribes.
  double unit_m = 1;
  // True: gmsh recognises the ending. False: gmsh would read the file as a program in its own language.
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

// Returns the name's ending in lower case, with its dot; empty if there is none.
std::string ending_of(const std::filesystem::path& path);

// `ending` must be in lower case, with its dot.
bool has_ending(const std::filesystem::path& path, std::string_view ending);

// Returns the endings of all bodies, for messages: ".obj .stl ... (surfaces), .step ... (geometries), .msh ...
// (meshes)".
std::string endings_of_bodies();

// The endings of the examples among these kinds, for help texts: ".geo .step .brep". One kind comes after the other.
std::string example_endings(std::initializer_list<FileKind> kinds);

}  // namespace ringdown
