// An elastic solid with different constants along three axes at right angles. Axis 1 runs along the grain. [any thread]
//
// For wood the axes are those of the trunk: 1 = L along it, 2 = R out from its middle, 3 = T around it. With stresses
// s and engineering strains e in the order 11 22 33 23 13 12, e = S s and
//
//       | 1/E1     -nu12/E1  -nu13/E1                    |
//       | -nu12/E1  1/E2     -nu23/E2                    |
//   S = | -nu13/E1 -nu23/E2   1/E3                       |     nu_ij = - e_jj / e_ii when s_ii alone acts
//       |                             1/G23              |     (Lekhnitskii, Theory of Elasticity of an
//       |                                   1/G13        |      Anisotropic Body, section 3)
//       |                                         1/G12  |
//
// A transversely isotropic solid has E2 = E3, nu12 = nu13, G12 = G13 and G23 = E2 / (2 (1 + nu23)).
#pragma once

#include <array>
#include <cmath>

namespace ringdown::modal {

struct Orthotropy {
  std::array<double, 3> youngs_modulus_pa = {};  // E1 E2 E3, > 0
  std::array<double, 3> poisson_ratio = {};      // nu12 nu13 nu23
  std::array<double, 3> shear_modulus_pa = {};   // G12 G13 G23, > 0
  // Loss factors of E1 E2 E3 G12 G13 G23, each over the material's own (Material::loss_factors or beta).
  std::array<double, 6> loss = {1, 1, 1, 1, 1, 1};
  friend bool operator==(const Orthotropy&, const Orthotropy&) = default;
};

// Returns the solid with all moduli `factor` times as large.
inline Orthotropy stiffer(Orthotropy solid, double factor) {
  for (double& modulus : solid.youngs_modulus_pa) modulus *= factor;
  for (double& modulus : solid.shear_modulus_pa) modulus *= factor;
  return solid;
}

// Returns true if the solid is stable: S is positive definite.
inline bool is_stable(const Orthotropy& solid) {
  const auto& [e, nu, g, loss] = solid;
  for (int i = 0; i < 3; ++i) {
    if (!(e[i] > 0 && g[i] > 0 && std::isfinite(e[i]) && std::isfinite(g[i]))) return false;
  }
  // Minors of the upper left block, its rows and columns multiplied by sqrt(E_i).
  const double a = -nu[0] * std::sqrt(e[1] / e[0]), b = -nu[1] * std::sqrt(e[2] / e[0]),
               c = -nu[2] * std::sqrt(e[2] / e[1]);
  return 1 - a * a > 1e-9 && 1 - b * b > 1e-9 && 1 - c * c > 1e-9 && 1 - a * a - b * b - c * c + 2 * a * b * c > 1e-9;
}

// Returns true if the solid is isotropic in planes across axis 1, to rounding. The direction of axis 2 then does not
// matter.
inline bool is_transversely_isotropic(const Orthotropy& solid) {
  const auto same = [](double a, double b) { return a - b <= 1e-9 * a && b - a <= 1e-9 * b; };
  const auto& [e, nu, g, loss] = solid;
  return same(e[1], e[2]) && nu[0] == nu[1] && same(g[0], g[1]) && same(g[2], e[1] / (2 * (1 + nu[2]))) &&
         loss[1] == loss[2] && loss[3] == loss[4];
}

}  // namespace ringdown::modal
