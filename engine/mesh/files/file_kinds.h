// Tells the kind of a file that holds a body, by its format (engine/base/file_format.h) and a look into it. Needs none
// of the libraries that read such files. [any thread]
#pragma once

#include <filesystem>

namespace ringdown::mesh {

// The variable of a .geo file that is handed over, in the file's unit, when a mesh size is chosen or named.
inline constexpr const char* kMeshSizeName = "mesh_size";

// A body in any of the forms that are read; of a TetGen mesh the .node file, and no .glb, which may be a bank.
bool is_body_file(const std::filesystem::path& path);

// A surface (surface_file.h).
bool is_surface_file(const std::filesystem::path& path);

// True for the files that gmsh meshes; a .geo file may still hold a mesh.
bool is_geometry_file(const std::filesystem::path& path);

// True for a .geo file that gives mesh_size a value. Whether its mesh depends on that, only gmsh can say
// (Sketch::sized_by_file in body.h).
bool declares_mesh_size(const std::filesystem::path& path);

// The unit that the file states [m], 1 if it states none. .step and .iges always state one, and gmsh converts them to
// millimetres; a .unv may state one.
double unit_in_file(const std::filesystem::path& path);

}  // namespace ringdown::mesh
