// What a file of a body is, by its name and a look into it; without the libraries that read it. [any thread]
#pragma once

#include <filesystem>

namespace ringdown::mesh {

// A body in any of the forms that are read, by the name's ending in any case; of a TetGen mesh the .node file, and no
// .glb, which may be a bank.
bool is_body_file(const std::filesystem::path& path);

// A surface, by the name's ending in any case (surface_file.h).
bool is_surface_file(const std::filesystem::path& path);

// True for the files that gmsh meshes, by their names' endings; a .geo file may still hold a mesh.
bool is_geometry_file(const std::filesystem::path& path);

// True for a .geo file that gives mesh_size a value, so that it need not be chosen for it.
bool names_mesh_size(const std::filesystem::path& path);

// What the file says its unit is, else 1: .step and .iges say it, and gmsh hands them over in millimetres; a .unv may.
double unit_in_file(const std::filesystem::path& path);

}  // namespace ringdown::mesh
