// How thick a body's walls are. [worker]
#pragma once

#include "engine/mesh/triangle_mesh.h"

namespace ringdown::mesh {

inline constexpr double kMinThicknessShare = 0.05;  // of the area may be thinner

// The thickness [m] below which kMinThicknessShare of the surface lies, measured from up to 2,000 places straight
// inward. The surface is turned outward; holes matter little. 0 when no ray meets anything.
double wall_thickness(const TriangleMesh& surface);

}  // namespace ringdown::mesh
