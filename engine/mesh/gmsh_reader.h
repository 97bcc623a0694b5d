// Meshes from files, by gmsh. Links GPL code: only ringdown-bake and tests use it. [worker, one call at a
// time: gmsh keeps its state in globals, so calls wait for each other]
//
// Two kinds of files:
//   a mesh      .msh .vtk .unv .mesh .bdf ... with tetrahedra of 4, 10, 20 or 35 nodes; read as it is.
//   a geometry  .geo (parametric), .step, .brep: meshed here, elements curved where the geometry is.
// A .geo file takes numbers from outside through DefineConstant:
//   DefineConstant[ length = 350, mesh_size = 10 ];   // defaults, in the file's unit
// and `mesh_size` is always handed over that way too, for files that place their own nodes (Transfinite,
// Layers). A .geo file is a program and may run commands: open only those you trust.
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/mesh_check.h"

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace ringdown::mesh {

struct GmshOptions {
  std::optional<double> unit_m;              // length of one unit, e.g. 0.001 for millimetres; none: unit_in_file()
  double mesh_size_m = 0;                    // longest edge, for a geometry; never above a tenth of its diagonal
  double edge_size_m = 0;                    // the same along sharp edges, growing to mesh_size_m inside; 0: no less
  int order = 3;                             // 1: straight elements, 2 to 4: curved ones. For a geometry only
  std::map<std::string, double> parameters;  // DefineConstant names of a .geo, in the file's unit
};

// Reads or meshes `path` and checks it (check_mesh). Where curved elements of a geometry would fold, gmsh may move
// their inner nodes; those that still fold become straight, and are counted. Prints nothing. Fails with one sentence
// when gmsh does, when a parameter is not one of the file's, when there are no tetrahedra, or other solid elements
// beside them.
//
// Displacement changes within a thickness or so of a sharp edge, however long the waves: edge_size_m is for that. It is
// not used where a .geo file has size fields of its own.
Result<CheckedMesh> read_with_gmsh(const std::filesystem::path& path, const GmshOptions& options);

// What the file says its unit is, else 1: .step and .iges say it, and gmsh hands them over in millimetres; a .unv may.
double unit_in_file(const std::filesystem::path& path);

// True for the files that are meshed here, by their names' endings; a .geo file may still hold a mesh.
bool is_geometry_file(const std::filesystem::path& path);

// True for a .geo file that gives mesh_size a value, so that it need not be chosen for it.
bool names_mesh_size(const std::filesystem::path& path);

// gmsh between initialize() and finalize(). [worker; calls of several threads wait for each other, because gmsh keeps
// its state in globals]

// Silent, on one thread, so that the same input gives the same mesh on every machine.
class GmshSession {
 public:
  GmshSession();
  ~GmshSession();
  GmshSession(const GmshSession&) = delete;
  GmshSession& operator=(const GmshSession&) = delete;

  // The first error logged so far, without its label.
  [[nodiscard]] std::optional<std::string> first_error() const;

 private:
  std::lock_guard<std::mutex> lock_;
};

}  // namespace ringdown::mesh
