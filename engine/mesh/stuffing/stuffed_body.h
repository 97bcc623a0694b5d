// A body of a surface that gmsh cannot fill as it is: with holes that nobody can close, or cutting itself. [worker]
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/body.h"
#include "engine/mesh/fill.h"
#include "engine/mesh/triangle_mesh.h"

#include <string>

namespace ringdown::mesh {

// The thickness [m] of the walls between the inside, where the winding number is above one half, and the outside, below
// which kMinThicknessShare of the surface lies. Copies of walls, folds and what lies within others do not count. 0 when
// nothing is inside.
double wall_of_soup(const TriangleMesh& surface);

// Stuffs the surface with cells of at most half of its thinnest wall and has gmsh fill the skin of that, in elements of
// options.size_m (0: a twentieth of the diagonal) and options.order: kRefilled. Where gmsh cannot, the body is stuffed
// with as many straight elements as order 2 can be solved with: kStuffed. options.wall_m is not used. Fails as stuff()
// does, and when cells as thick as the walls would be too many: the sentence names the size that it would take. With
// `force_coarse` only when nothing would be left of the walls; Body::wall_elements says how many cells lie across them.
Result<Body> make_stuffed(const TriangleMesh& surface, const FillOptions& options, bool force_coarse,
                          const std::string& name, const Progress& progress);

}  // namespace ringdown::mesh
