// Tetrahedra inside any surface that looks closed: isosurface stuffing. [worker]
//
//   Result<Stuffed> stuffed = stuff(soup, {.size_m = 0.003});
//   if (!stuffed) return fail(stuffed.error());
//
// The surface may be a soup: with holes, doubled or overlapping patches, cutting itself. Inside is where its winding
// number (winding_number.h) is above one half.
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/mesh/triangle_mesh.h"

namespace ringdown::mesh {

inline constexpr double kMostLatticePoints = 50e6;  // of the lattice over the body's box, which decides the memory

struct StuffOptions {
  double size_m = 0;  // edge of the lattice's cubes; elements' edges are about as long
  int threads = 0;    // 0: as many as there are processors
};

struct Stuffed {
  TetMesh mesh;          // of four nodes, positively oriented; passes check_mesh()
  int crumbs = 0;        // parts of a few elements, removed
  int hinges = 0;        // elements removed so that nothing hangs by an edge or a point
  bool turned = false;   // the surface was inside out as a whole
};

// The same bits for any number of threads. Progress stage: "stuffing". Fails with one sentence: nothing is inside, the
// lattice would be larger than kMostLatticePoints, cancelled.
Result<Stuffed> stuff(const TriangleMesh& surface, const StuffOptions& options, const Progress& progress = {});

}  // namespace ringdown::mesh
