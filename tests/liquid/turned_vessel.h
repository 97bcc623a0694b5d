// Vessels as surfaces of revolution, for the tests of liquids. Shares no code with engine/liquid.
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <utility>
#include <vector>

namespace ringdown {

// The surface that a closed line of (radius, height) makes around the z axis. The line goes up on the outside and comes
// back inside; it may begin and end on the axis. Pieces of the line longer than `side` are divided.
mesh::TriangleMesh turned(const std::vector<std::pair<double, double>>& line, double side, int around);

// Several surfaces as one.
mesh::TriangleMesh together(const std::vector<mesh::TriangleMesh>& surfaces);

}  // namespace ringdown
