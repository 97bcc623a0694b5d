// Meshes from files, by gmsh. Links GPL code: only ringdown-bake and tests use it. [worker, one call at a
// time: gmsh keeps its state in globals, so calls wait for each other]
//
// Two kinds of files:
//   a mesh      .msh .vtk .unv .mesh .bdf ... with tetrahedra of 4, 10, 20 or 35 nodes; read as it is.
//   a geometry  .geo (parametric), .step, .brep: meshed here, elements curved where the geometry is.
// A .geo file takes numbers from outside through DefineConstant:
//   DefineConstant[ length = 350, mesh_size = 10 ];   // defaults, in the file's unit
// and `mesh_size` is always handed over that way too, for files that place their own nodes (Transfinite, Layers). A
// .geo file is a program; check_geo() (geo_language.h) refuses what does more than describe a body.
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/body.h"

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

namespace ringdown::mesh {

// Reads or meshes `path` and checks it (check_mesh). Where curved elements of a geometry would fold, gmsh may move
// their nodes; those that still fold become straight, and are counted. Where more than a five-hundredth of the volume
// that OpenCASCADE knows is lost by that, bends get smaller elements; what is lost all the same is spread over the skin
// as CheckedMesh::gaps_m, which is empty otherwise. Prints nothing. Fails with one sentence
// when gmsh does, when a parameter is not one of the file's, when there are no tetrahedra, or other solid elements
// beside them.
//
// Displacement changes within a thickness or so of a sharp edge, however long the waves: edge_size_m is for that. It is
// not used where a .geo file has size fields of its own.
Result<CheckedMesh> read_with_gmsh(const std::filesystem::path& path, const GmshOptions& options);

// Returns true where the mesh of a .geo file changes with its variable mesh_size. The curves of the body, of this
// length, are meshed with the file's own value and with two others. Also true where that fails.
bool depends_on_mesh_size(const std::filesystem::path& path, const GmshOptions& options, double length_m);

// Refuses a mesh size that would fill memory and time, by the number of elements that it means: tetrahedra in
// a volume, and triangles on an area [m^2], where it is known. Such a body is as long as the diagonal [m].
struct Extent {
  double volume_m3 = 0, area_m2 = 0, diagonal_m = 0;
};
inline constexpr double kMaxElements = 20e6;
Result<void> check_element_count(const std::filesystem::path& path, const Extent& extent, double mesh_size_m);

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
