#include "engine/base/file_format.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace ringdown {
namespace {

constexpr std::array kFormats = {
    FileFormat{.ending = ".stl", .kind = FileKind::surface, .known_to_gmsh = true},
    FileFormat{.ending = ".obj", .kind = FileKind::surface, .known_to_gmsh = true},
    FileFormat{.ending = ".ply", .kind = FileKind::surface, .known_to_gmsh = true},
    FileFormat{.ending = ".off", .kind = FileKind::surface, .known_to_gmsh = true},
    FileFormat{.ending = ".gltf", .kind = FileKind::gltf, .has_companions = true},
    FileFormat{.ending = ".glb", .kind = FileKind::gltf, .is_body = false},  // a bank, in a folder
    // CAD files state their unit, and gmsh converts them to millimetres.
    FileFormat{.ending = ".step", .kind = FileKind::geometry, .unit_m = 0.001, .known_to_gmsh = true},
    FileFormat{.ending = ".stp", .kind = FileKind::geometry, .unit_m = 0.001, .known_to_gmsh = true},
    FileFormat{.ending = ".iges", .kind = FileKind::geometry, .unit_m = 0.001, .known_to_gmsh = true},
    FileFormat{.ending = ".igs", .kind = FileKind::geometry, .unit_m = 0.001, .known_to_gmsh = true},
    FileFormat{.ending = ".brep", .kind = FileKind::geometry, .known_to_gmsh = true},
    FileFormat{.ending = ".brp", .kind = FileKind::geometry, .known_to_gmsh = true},
    FileFormat{.ending = ".xao", .kind = FileKind::geometry, .known_to_gmsh = true},
    FileFormat{.ending = ".geo", .kind = FileKind::program},
    FileFormat{.ending = ".geo_unrolled", .kind = FileKind::program, .is_body = false},
    // gmsh recognises its own meshes by their first line, and reads other files with these endings as programs.
    FileFormat{.ending = ".msh", .kind = FileKind::gmsh_mesh},
    FileFormat{.ending = ".msh2", .kind = FileKind::gmsh_mesh, .is_body = false},
    FileFormat{.ending = ".msh4", .kind = FileKind::gmsh_mesh, .is_body = false},
    FileFormat{.ending = ".mesh", .kind = FileKind::gmsh_mesh, .known_to_gmsh = true},
    FileFormat{.ending = ".vtk", .kind = FileKind::gmsh_mesh, .known_to_gmsh = true},
    FileFormat{.ending = ".unv", .kind = FileKind::gmsh_mesh, .known_to_gmsh = true},
    FileFormat{.ending = ".bdf", .kind = FileKind::gmsh_mesh, .known_to_gmsh = true},
    FileFormat{.ending = ".nas", .kind = FileKind::gmsh_mesh, .known_to_gmsh = true, .is_body = false},
    FileFormat{.ending = ".med", .kind = FileKind::gmsh_mesh, .known_to_gmsh = true, .is_body = false},
    FileFormat{.ending = ".cgns", .kind = FileKind::gmsh_mesh, .known_to_gmsh = true, .is_body = false},
    FileFormat{.ending = ".inp", .kind = FileKind::tetrahedra},
    FileFormat{.ending = ".node", .kind = FileKind::tetrahedra, .has_companions = true},
    FileFormat{.ending = ".ele", .kind = FileKind::tetrahedra, .is_body = false, .has_companions = true},
    FileFormat{.ending = ".veg", .kind = FileKind::tetrahedra},
    FileFormat{.ending = ".tet", .kind = FileKind::tetrahedra},
    FileFormat{.ending = ".toml", .kind = FileKind::table, .is_body = false},
    FileFormat{.ending = ".wav", .kind = FileKind::sound, .is_body = false},
    FileFormat{.ending = ".flac", .kind = FileKind::sound, .is_body = false},
    FileFormat{.ending = ".aif", .kind = FileKind::sound, .is_body = false},
    FileFormat{.ending = ".aiff", .kind = FileKind::sound, .is_body = false},
    FileFormat{.ending = ".ogg", .kind = FileKind::sound, .is_body = false},
};

template <class Wanted>
std::string endings(Wanted wanted) {
  std::string list;
  for (const FileFormat& format : kFormats) {
    if (wanted(format)) list += (list.empty() ? "" : " ") + std::string(format.ending);
  }
  return list;
}

}  // namespace

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
  return endings([](const FileFormat& f) { return f.kind == surface || f.kind == gltf; }) + " (surfaces), " +
         endings([](const FileFormat& f) { return f.kind == geometry || f.kind == program; }) + " (geometries), " +
         endings([](const FileFormat& f) { return f.kind == tetrahedra || f.kind == gmsh_mesh; }) + " (meshes)";
}

}  // namespace ringdown
