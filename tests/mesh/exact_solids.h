// Volumes of bodies and of what they have in common, in rational arithmetic (GMP): an oracle that shares nothing with
// the meshing. A body is a list of convex pieces that have no volume in common.
#pragma once

#include <Eigen/Core>
#include <gmpxx.h>

#include <array>
#include <vector>

namespace ringdown::test {

using ExactPoint = std::array<mpq_class, 3>;

// A convex polyhedron as its faces, counter-clockwise from outside. No faces: it is empty.
class ConvexSolid {
 public:
  // Points are the corners; faces, which are cut into triangles, are plane up to rounding.
  ConvexSolid(const std::vector<Eigen::RowVector3d>& points, const std::vector<std::vector<int>>& faces);

  // What is left of it on the inner side of all faces of the other one.
  [[nodiscard]] ConvexSolid common_with(const ConvexSolid& other) const;

  [[nodiscard]] double volume() const;

 private:
  ConvexSolid() = default;
  void cut(const ExactPoint& on, const ExactPoint& normal);

  std::vector<std::vector<ExactPoint>> faces_;
};

using Pieces = std::vector<ConvexSolid>;

// Of what every body of the list has in common with all others.
Pieces common(const Pieces& a, const Pieces& b);
double volume_of(const Pieces& pieces);

// By inclusion and exclusion.
double volume_of_union(const std::vector<Pieces>& bodies);

}  // namespace ringdown::test
