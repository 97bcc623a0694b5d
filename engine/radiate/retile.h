// A closed surface in triangles of another size. Does without CGAL, because the programs that bake do not link it.
// [worker]
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <vector>

namespace ringdown::radiate {

// Sides longer than 1.45 times `side_m` are halved. Sides shorter than 0.9 times `side_m` are collapsed onto one of
// their ends, unless that would turn a triangle by more than 35 degrees or make a needle. Sides are swapped where that
// widens the narrowest angle. Sides sharper than 40 degrees stay, so a thin wall keeps its rim and its two faces apart.
// Nodes lie on the old surface. For a surface with mirror planes (panels.h) the part may be given; its sides on a plane
// stay there. (The steps are those of Botsch & Kobbelt, A remeshing approach to multiresolution modeling, 2004.)
mesh::TriangleMesh retile(const mesh::TriangleMesh& surface, double side_m, int mirrors = 0);
// Takes a side for each node instead, and for the side between two nodes the mean of theirs.
mesh::TriangleMesh retile(const mesh::TriangleMesh& surface, const std::vector<double>& sides_m, int mirrors = 0);

}  // namespace ringdown::radiate
