// Static integrals (without the wave) between triangles that touch or lie close, where 1/R is too steep for sums over
// the middles of sides. They depend on the surface alone and serve every wavenumber. [worker]
#pragma once

#include "engine/radiate/panels.h"

#include <array>
#include <vector>

namespace ringdown::radiate {

// Corrections to the sums over the middles of sides, in which 1/R counts as 0 where two middles coincide: exact
// integrals minus these sums, over pairs of triangles closer than kNearSides longest sides. Rows are the hat functions
// of the point x, columns those of y.
struct NearIntegrals {
  struct Entry {
    float curls = 0;    // [m]: integral of curl(x) . curl(y) / (4 pi R)
    float normals = 0;  // [m^3]: integral of n(x) . n(y) hat(x) hat(y) / (4 pi R)
    float slopes = 0;   // [m^2]: integral of hat(x) hat(y) d/dn(x) of 1 / (4 pi R)
  };
  std::vector<int> begin;      // V + 1: where each row begins in the lists below
  std::vector<int> columns;    // in ascending order within a row
  std::vector<Entry> entries;  // one per column number
};

inline constexpr double kNearSides = 2;  // limit of the distance between centres

// The corrections between a part (x) and one of its images (y).
NearIntegrals near_integrals(const Panels& part, int image = 0);

// The static potential of one flat triangle. For each corner's hat function: the integral of hat / R over the triangle,
// and its gradient at `point`. Closed forms: Wilton et al., IEEE Trans. Antennas Propag. 32 (1984) 276; Graglia, ibid.
// 41 (1993) 1448.
struct TrianglePotential {
  std::array<double, 3> value{};  // [m]
  std::array<Eigen::Vector3d, 3> gradient{};
};
TrianglePotential potential_of(const Panels& panels, int triangle, const Eigen::Vector3d& point);

}  // namespace ringdown::radiate
