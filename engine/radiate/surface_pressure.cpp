#include "engine/radiate/surface_pressure.h"

#include "engine/radiate/near_integrals.h"
#include "engine/radiate/skin.h"

#include <cmath>
#include <complex>
#include <numbers>

namespace ringdown::radiate {

Eigen::RowVectorXcd pressure_at(std::span<const Panels> images, int image_class, int triangle, double wavenumber_rad_m,
                                const std::vector<double>& coupling, const Eigen::MatrixXcd& layers) {
  using Complex = std::complex<double>;
  constexpr double kNear = 12;  // over the root of a triangle's area: eight sides
  constexpr double kSphere = 4 * std::numbers::pi;
  const Complex i(0, 1);
  const double k = wavenumber_rad_m;
  const Eigen::Vector3d x = images[0].centers[triangle];
  Eigen::RowVectorXcd sum = Eigen::RowVectorXcd::Zero(layers.cols());
  for (const int corner : images[0].corners[triangle]) sum += layers.row(corner) / 6.0;
  for (std::size_t image = 0; image < images.size(); ++image) {
    const Panels& panels = images[image];
    const double sign = sign_of(image_class, static_cast<int>(image));
    for (int t = 0; t < panels.triangle_count(); ++t) {
      const bool itself = image == 0 && t == triangle;
      const bool near = (panels.centers[t] - x).squaredNorm() < kNear * kNear * panels.areas[t];
      const TrianglePotential potential = near ? potential_of(panels, t, x) : TrianglePotential{};
      for (int c = 0; near && c < 3; ++c) {
        const int node = panels.corners[t][c];
        const double dipole = itself ? 0 : -potential.gradient[c].dot(panels.normals[t]) / kSphere;
        sum += sign * (dipole - i * coupling[node] * potential.value[c] / kSphere) * layers.row(node);
      }
      for (const int s : panels.sides_of[t]) {
        const Side& side = panels.sides[s];
        const Eigen::Vector3d way = side.middle - x;
        const double distance = way.norm(), kr = k * distance, weight = panels.areas[t] / 3 / kSphere;
        const Complex wave = std::polar(1.0, kr);
        const double still = near ? 1 : 0;
        Complex simple = i * k, slope = -k * k / 2;
        if (kr > 1e-3 || !near) {
          simple = (wave - still) / distance;
          slope = (wave * Complex(-1, kr) + still) / (distance * distance);
        }
        const double along = distance > 0 ? panels.normals[t].dot(way) / distance : 0;
        for (int end = 0; end < 2; ++end) {
          const int node = side.nodes[end];
          sum += sign * (weight / 2) * (slope * along - i * coupling[node] * simple) * layers.row(node);
        }
      }
    }
  }
  return sum;
}

}  // namespace ringdown::radiate
