// Triangles as the readers of surfaces collect them, before points that a file repeats become one. [any thread]
#pragma once

#include "engine/base/result.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace ringdown::mesh {

struct TriangleSoup {
  std::vector<Eigen::RowVector3d> points;
  std::vector<std::array<std::int32_t, 3>> triangles;  // numbers of points
  double rounding = 0;  // the distance of neighbouring numbers that coordinates can have, at most; 0: they are doubles
  std::vector<std::string> notes;  // what was read otherwise than the file says, as sentences
};

// The distance of a 32-bit float of this size to the next one.
double float_spacing(double size);
double float_spacing(const std::vector<Eigen::RowVector3d>& points);  // of their largest coordinate

// Cuts a polygon into triangles, which have all of its corners and its sense; less than three corners are left out. The
// corners are numbers of points that exist. A polygon may be concave, and bent a little; what cuts itself becomes some
// triangles. O(corners) where it is convex, else mostly O(corners^2).
void add_polygon(TriangleSoup& soup, std::span<const std::int32_t> corners);

}  // namespace ringdown::mesh
