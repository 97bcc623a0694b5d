// Fills a sound surface with tetrahedra, by gmsh. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/mesh_check.h"
#include "engine/mesh/surface/parted_surface.h"
#include "engine/mesh/triangle_mesh.h"

#include <string>

namespace ringdown::mesh {

struct FillOptions {
  double size_m = 0;   // longest edge; 0: keeps the surface's own triangles, with as few elements inside as possible
  int order = 3;       // 1: straight elements; 2 to 4: outer faces follow the surface
  double wall_m = 0;   // the thinnest wall; 0: not known
  bool quick = false;  // coarser triangles at bends, which may lie farther from the surface until nodes are put back
};

struct Filled {
  CheckedMesh mesh;
  std::string note;  // the reason why the mesh differs from the options; or empty
};

// Fills `surface`, which must be sound() (surface_check.h). Cavities stay empty, and each further shell becomes a
// separate piece. The surface is first cut into triangles of the requested size, smaller where it bends, keeping sharp
// edges (remesh.h), and finer where triangles would leave the surface by more than a seventh of the body's thickness
// there. If this fails, the surface's own triangles are used if they are few enough. Errors contain `name`. Fails if
// gmsh fails, or if the result is not a valid mesh (check_mesh) or has another volume.
Result<Filled> fill(const TriangleMesh& surface, const FillOptions& options, const std::string& name);

// Fills a body and its parts, which share the nodes of the surfaces between them. Each part is a group of elements with
// the name of its surface (MeshGroups::volumes). Curved elements also follow the surfaces between parts. Fails as
// fill() does, and if a part gets another volume.
Result<Filled> fill_parts(const PartedSurface& surface, const FillOptions& options, const std::string& name);

}  // namespace ringdown::mesh
