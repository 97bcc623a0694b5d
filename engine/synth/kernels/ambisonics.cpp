#include "engine/synth/kernels/ambisonics.h"

#include <cmath>
#include <numbers>

namespace ringdown::synth {

// Real spherical harmonics without the Condon-Shortley phase, as homogeneous polynomials of the direction's components.
// See M. Chapman et al., "A standard for interchange of ambisonic signal sets", Ambisonics Symposium, Graz, 2009.
AmbisonicGains encode(Vec3 towards) REALTIME {
  const auto& [x, y, z] = towards;
  constexpr double k3 = std::numbers::sqrt3;
  const double across = x * x + y * y;
  const double k58 = std::sqrt(5.0 / 8), k38 = std::sqrt(3.0 / 8), k15 = std::sqrt(15.0);
  return {1,
          y,
          z,
          x,
          k3 * x * y,
          k3 * y * z,
          z * z - 0.5 * across,
          k3 * x * z,
          0.5 * k3 * (x * x - y * y),
          k58 * y * (3 * x * x - y * y),
          k15 * x * y * z,
          k38 * y * (4 * z * z - across),
          z * (z * z - 1.5 * across),
          k38 * x * (4 * z * z - across),
          0.5 * k15 * z * (x * x - y * y),
          k58 * x * (x * x - 3 * y * y)};
}

}  // namespace ringdown::synth
