#include "engine/base/file_format.h"
#include "engine/base/formatted.h"
#include "engine/base/version.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace ringdown {

// Only this file is compiled with the version, so that a release compiles little anew.
const char* const kVersion = RINGDOWN_VERSION;

namespace {

constexpr auto kFormats = [] {
  using enum FileKind;
  using enum Companions;
  return std::to_array<FileFormat>({
      {.ending = ".stl", .kind = surface, .known_to_gmsh = true, .example = true},
      {.ending = ".obj", .kind = surface, .known_to_gmsh = true, .example = true},
      {.ending = ".ply", .kind = surface, .known_to_gmsh = true, .example = true},
      {.ending = ".off", .kind = surface, .known_to_gmsh = true},
      {.ending = ".gltf", .kind = gltf, .companions = uris},
      {.ending = ".glb", .kind = gltf, .is_body = false, .example = true},  // a bank, in a folder
      // CAD programs' files say their unit, and gmsh hands them over in millimetres.
      {.ending = ".step",
       .kind = geometry,
       .unit_m = 0.001,
       .known_to_gmsh = true,
       .opencascade = "step",
       .example = true},
      {.ending = ".stp", .kind = geometry, .unit_m = 0.001, .known_to_gmsh = true, .opencascade = "step"},
      {.ending = ".iges", .kind = geometry, .unit_m = 0.001, .known_to_gmsh = true, .opencascade = "iges"},
      {.ending = ".igs", .kind = geometry, .unit_m = 0.001, .known_to_gmsh = true, .opencascade = "iges"},
      {.ending = ".brep", .kind = geometry, .known_to_gmsh = true, .opencascade = "brep", .example = true},
      {.ending = ".brp", .kind = geometry, .known_to_gmsh = true, .opencascade = "brep"},
      {.ending = ".xao", .kind = geometry, .known_to_gmsh = true},
      {.ending = ".geo", .kind = program, .example = true, .companions = includes},
      {.ending = ".geo_unrolled", .kind = program, .is_body = false, .companions = includes},
      // gmsh knows its own meshes by their first line, and reads others with these endings in its language.
      {.ending = ".msh", .kind = gmsh_mesh, .example = true},
      {.ending = ".msh2", .kind = gmsh_mesh, .is_body = false},
      {.ending = ".msh4", .kind = gmsh_mesh, .is_body = false},
      {.ending = ".mesh", .kind = gmsh_mesh, .known_to_gmsh = true},
      {.ending = ".vtk", .kind = gmsh_mesh, .known_to_gmsh = true, .example = true},
      {.ending = ".unv", .kind = gmsh_mesh, .known_to_gmsh = true},
      {.ending = ".bdf", .kind = gmsh_mesh, .known_to_gmsh = true, .companions = includes},
      {.ending = ".nas", .kind = gmsh_mesh, .known_to_gmsh = true, .is_body = false, .companions = includes},
      {.ending = ".med", .kind = gmsh_mesh, .known_to_gmsh = true, .is_body = false},
      {.ending = ".cgns", .kind = gmsh_mesh, .known_to_gmsh = true, .is_body = false},
      {.ending = ".inp", .kind = tetrahedra},
      {.ending = ".node", .kind = tetrahedra, .companions = siblings, .siblings = {".ele", ".face"}},
      {.ending = ".ele", .kind = tetrahedra, .is_body = false, .companions = siblings, .siblings = {".node", ".face"}},
      {.ending = ".veg", .kind = tetrahedra},
      {.ending = ".tet", .kind = tetrahedra},
      {.ending = ".toml", .kind = table, .is_body = false},
      {.ending = ".wav", .kind = sound, .is_body = false},
      {.ending = ".flac", .kind = sound, .is_body = false},
      {.ending = ".aif", .kind = sound, .is_body = false},
      {.ending = ".aiff", .kind = sound, .is_body = false},
      {.ending = ".ogg", .kind = sound, .is_body = false},
  });
}();

template <class Wanted>
std::string endings(Wanted wanted) {
  std::string list;
  for (const FileFormat& format : kFormats) {
    if (wanted(format)) list += (list.empty() ? "" : " ") + std::string(format.ending);
  }
  return list;
}

}  // namespace

std::span<const FileFormat> file_formats() { return kFormats; }

std::string ending_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

bool has_ending(const std::filesystem::path& path, std::string_view ending) { return ending_of(path) == ending; }

const FileFormat* format_of(const std::filesystem::path& path) {
  const auto* const found = std::ranges::find(kFormats, std::string_view(ending_of(path)), &FileFormat::ending);
  return found == kFormats.end() ? nullptr : found;
}

bool is_of_kind(const std::filesystem::path& path, FileKind kind) {
  const FileFormat* format = format_of(path);
  return format && format->kind == kind;
}

std::string endings_of_bodies() {
  using enum FileKind;
  return formatted("{} (surfaces), {} (geometries), {} (meshes)",
                   endings([](const FileFormat& f) { return f.kind == surface || f.kind == gltf; }),
                   endings([](const FileFormat& f) { return f.kind == geometry || f.kind == program; }),
                   endings([](const FileFormat& f) { return f.kind == tetrahedra || f.kind == gmsh_mesh; }));
}

std::string example_endings(std::initializer_list<FileKind> kinds) {
  std::string list;
  for (const FileKind kind : kinds) {
    const std::string some = endings([kind](const FileFormat& f) { return f.kind == kind && f.example; });
    list += (list.empty() ? "" : " ") + some;
  }
  return list;
}

}  // namespace ringdown
