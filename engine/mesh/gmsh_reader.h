// Reads and makes meshes with gmsh. Links GPL code: only ringdown-bake and tests use this header. [worker, one call at
// a time: gmsh keeps its state in globals, so calls wait for each other]
//
// Two kinds of files:
//   a mesh      .msh .vtk .unv .mesh .bdf ... with tetrahedra of 4, 10, 20 or 35 nodes; read unchanged.
//   a geometry  .geo (parametric), .step, .brep: meshed here, elements curved where the geometry is.
// A .geo file takes numbers from outside through DefineConstant:
//   DefineConstant[ length = 350, mesh_size = 10 ];   // defaults, in the file's unit
// and `mesh_size` is always passed that way, too, for files that place their own nodes (Transfinite, Layers). A .geo
// file is a program; check_geo() (geo_language.h) refuses programs that do more than describe a body.
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/body.h"

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

namespace ringdown::mesh {

// Reads or meshes `path` and checks the mesh (check_mesh). If curved elements of a geometry would fold, gmsh may move
// their nodes; elements that still fold become straight, and are counted. If more than a five-hundredth of the volume
// that OpenCASCADE knows is lost in this way, bends get smaller elements; a loss that remains is spread over the skin
// as CheckedMesh::gaps_m, which is empty otherwise. Prints nothing. Fails with one sentence if gmsh fails, if a
// parameter is not one of the file's, if there are no tetrahedra, or if there are other solid elements beside them.
//
// edge_size_m makes elements smaller at sharp edges, because displacement changes within about a thickness of an edge,
// however long the waves are. A .geo file with its own size fields ignores edge_size_m.
Result<CheckedMesh> read_with_gmsh(const std::filesystem::path& path, const GmshOptions& options);

// Returns true if the mesh of a .geo file depends on its variable mesh_size. The curves of the body, which has this
// length, are meshed with the file's own value and with two others. Also returns true if that fails.
bool depends_on_mesh_size(const std::filesystem::path& path, const GmshOptions& options, double length_m);

// The extent of a body [m^3, m^2, m], from which check_element_count() estimates the number of elements: tetrahedra in
// the volume, and triangles on the area if known. It refuses mesh sizes that would take too much memory and time.
struct Extent {
  double volume_m3 = 0, area_m2 = 0, diagonal_m = 0;
};
inline constexpr double kMaxElements = 20e6;
Result<void> check_element_count(const std::filesystem::path& path, const Extent& extent, double mesh_size_m);

// Runs gmsh between initialize() and finalize(). [worker; calls of several threads wait for each other, because gmsh
// keeps its state in globals]

// gmsh prints nothing and runs on one thread, so that equal input gives equal meshes on every machine.
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
