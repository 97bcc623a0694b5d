// A bank's record of how a liquid changes the modes of a body at any of its levels (docs/how/liquid.md). [any thread]
//
// The motions of the body are sums of N = F + M + R columns: F rigid motions (6, or none of a held body), the M modes
// of the bank, and R further ones; the liquid gives way in J motions of its own. Matrices are symmetric, and packed row
// by row up to the diagonal. Those of L levels are kept; in between each entry follows a cubic spline.
//
//   | K     |          | M_d + M_a   E |
//   |    C  | x = l    |    E^T      G | x       C = V^T E,  E, G of each level
//
// Column j of V says how the liquid gives way in motion j when the body moves slowly.
#pragma once

#include "engine/base/range.h"

#include <cstddef>
#include <vector>

namespace ringdown::modal {

inline constexpr std::size_t kMinLevels = 4, kMaxLevels = 64;
inline constexpr std::size_t kMaxLevelColumns = 600, kMaxLiquidMotions = 32;

constexpr std::size_t packed_size(std::size_t n) { return n * (n + 1) / 2; }

struct LiquidLevels {
  std::vector<double> level_m;    // L, ascending: from the bottom of the basin, where it is empty, up to its rim
  std::vector<double> volume_m3;  // L
  std::size_t rigid = 0, further = 0, liquid = 0;  // F, R, J
  std::vector<float> shapes;           // Q x P x 3 [kg^-1/2], of the first Q further ones; others count as 0
  std::vector<float> stiffness, mass;  // packed N: K [1/s^2] and M_d of the body alone
  std::vector<float> following;        // N x J: V
  std::vector<float> added;            // L x packed N: M_a
  std::vector<float> bond;             // L x N x J: E [s^2]
  std::vector<float> liquid_mass;      // L x packed J: G [s^4]
  std::vector<float> drag;             // L x M: the boundary layer takes drag sqrt(omega) of each mode [s^-1/2]

  [[nodiscard]] std::size_t levels() const { return level_m.size(); }
  [[nodiscard]] Range range_m() const { return {level_m.front(), level_m.back()}; }
  [[nodiscard]] std::size_t columns(std::size_t modes) const { return rigid + modes + further; }
};

}  // namespace ringdown::modal
