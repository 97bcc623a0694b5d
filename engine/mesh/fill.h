// The inside of a sound surface as tetrahedra, by gmsh. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/mesh_check.h"
#include "engine/mesh/surface/parted_surface.h"
#include "engine/mesh/triangle_mesh.h"

#include <string>

namespace ringdown::mesh {

struct FillOptions {
  double size_m = 0;   // longest edge; 0: the surface's own triangles, and as few inside as it takes
  int order = 3;       // 1: straight elements; 2 to 4: their outer faces follow the surface
  double wall_m = 0;   // the thinnest wall; 0: not known
  bool quick = false;  // coarser where the surface bends, and farther from it, before its nodes are put back on it
};

struct Filled {
  CheckedMesh mesh;
  std::string note;  // why it is not meshed as asked; or empty
};

// `surface` is sound() (surface_check.h); cavities stay empty, and each further shell is a piece of its own. It is
// first cut into triangles of the size asked for, smaller where it bends, keeping sharp edges (remesh.h), and finer
// where those would leave the surface by more than a seventh of what the body is thick there; where this fails, its own
// triangles serve, if they are few enough. `name` stands in the sentence. Fails when gmsh does, when what comes out is
// no mesh (check_mesh) or has another volume.
Result<Filled> fill(const TriangleMesh& surface, const FillOptions& options, const std::string& name);

// All of a body with its parts, which share the nodes of the surfaces between them. Each part is a group of elements
// with the name of its surface (MeshGroups::volumes). Curved elements follow the surfaces between parts, too. Fails as
// fill() does, and when a part comes out with another volume.
Result<Filled> fill_parts(const PartedSurface& surface, const FillOptions& options, const std::string& name);

}  // namespace ringdown::mesh
