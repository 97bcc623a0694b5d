// Makes a body of a surface that gmsh cannot fill: with holes that cannot be closed, or cutting itself. [worker]
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/body.h"
#include "engine/mesh/fill.h"
#include "engine/mesh/triangle_mesh.h"

#include <string>

namespace ringdown::mesh {

// Returns the thickness [m] of walls below which kMinThicknessShare of the surface lies; 0 if nothing is inside. A wall
// is measured from outside to outside through the inside, where the winding number is above one half, so duplicate
// walls, folds and parts inside others do not count.
double wall_of_soup(const TriangleMesh& surface);

// Stuffs the surface with cells of at most half of its thinnest wall and lets gmsh fill the resulting skin with
// elements of options.size_m (0: a twentieth of the diagonal) and options.order: kRefilled. If gmsh fails, the body is
// stuffed with as many straight elements as can be solved at order 2: kStuffed. options.wall_m is not used. Fails as
// stuff() does, and if cells as thick as the walls would be too many; the sentence names the required size. With
// `force_coarse` coarser cells are accepted unless nothing would be left of the walls; Body::wall_elements has the
// number of cells across the walls.
Result<Body> make_stuffed(const TriangleMesh& surface, const FillOptions& options, bool force_coarse,
                          const std::string& name, const Progress& progress);

}  // namespace ringdown::mesh
