#include "engine/radiate/surface_pressure.h"

#include "engine/radiate/near_integrals.h"
#include "engine/radiate/skin.h"

#include <cmath>
#include <complex>
#include <numbers>

namespace ringdown::radiate {
namespace {

using Complex = std::complex<double>;
constexpr double kSphere = 4 * std::numbers::pi;

}  // namespace

SurfacePressure::SurfacePressure(std::span<const Panels> images, int image_class, double wavenumber_rad_m,
                                 const std::vector<double>& coupling, const Eigen::MatrixXcd& layers)
    : images_(images), image_class_(image_class), k_(wavenumber_rad_m), coupling_(coupling), layers_(layers) {
  dipoles_.resize(images[0].side_count(), layers.cols());
  simple_.resize(images[0].side_count(), layers.cols());
  for (int s = 0; s < images[0].side_count(); ++s) {
    const int a = images[0].sides[s].nodes[0], b = images[0].sides[s].nodes[1];
    dipoles_.row(s) = (layers.row(a) + layers.row(b)) / 2;
    simple_.row(s) = Complex(0, -0.5) * (coupling[a] * layers.row(a) + coupling[b] * layers.row(b));
  }
}

void SurfacePressure::add_sides(const Panels& panels, const Eigen::Vector3d& x, double sign,
                                Eigen::RowVectorXcd& sum) const {
  for (int s = 0; s < panels.side_count(); ++s) {
    const Side& side = panels.sides[s];
    const Eigen::Vector3d way = side.middle - x;
    const double distance = way.norm(), kr = k_ * distance;
    double across = 0, area = 0;
    for (const int t : side.triangles) {
      if (t < 0) continue;
      across += panels.areas[t] / 3 * panels.normals[t].dot(way);
      area += panels.areas[t] / 3;
    }
    const Complex wave = std::polar(sign / (kSphere * distance), kr);
    sum += wave * Complex(-1, kr) * (across / (distance * distance)) * dipoles_.row(s) + wave * area * simple_.row(s);
  }
}

// Adds the exact static part of near triangles, and takes the part of the sum over the middles of sides away.
void SurfacePressure::mend_near(const Panels& panels, int itself, const Eigen::Vector3d& x, double sign,
                                Eigen::RowVectorXcd& sum) const {
  constexpr double kNear = 12;  // over the root of a triangle's area: eight sides
  const Complex i(0, 1);
  for (int t = 0; t < panels.triangle_count(); ++t) {
    if ((panels.centers[t] - x).squaredNorm() > kNear * kNear * panels.areas[t]) continue;
    const TrianglePotential potential = potential_of(panels, t, x);
    for (int c = 0; c < 3; ++c) {
      const int node = panels.corners[t][c];
      const double dipole = t == itself ? 0 : -potential.gradient[c].dot(panels.normals[t]) / kSphere;
      sum += sign * (dipole - i * coupling_[node] * potential.value[c] / kSphere) * layers_.row(node);
    }
    for (const int s : panels.sides_of[t]) {
      const Eigen::Vector3d way = panels.sides[s].middle - x;
      const double distance = way.norm(), weight = sign * panels.areas[t] / (3 * kSphere * distance);
      const double across = panels.normals[t].dot(way) / (distance * distance);
      sum += weight * across * dipoles_.row(s) - weight * simple_.row(s);
    }
  }
}

Eigen::RowVectorXcd SurfacePressure::at(int triangle) const {
  const Eigen::Vector3d x = images_[0].centers[triangle];
  Eigen::RowVectorXcd sum = Eigen::RowVectorXcd::Zero(layers_.cols());
  for (const int corner : images_[0].corners[triangle]) sum += layers_.row(corner) / 6.0;
  for (std::size_t image = 0; image < images_.size(); ++image) {
    const double sign = sign_of(image_class_, static_cast<int>(image));
    add_sides(images_[image], x, sign, sum);
    mend_near(images_[image], image == 0 ? triangle : -1, x, sign, sum);
  }
  return sum;
}

}  // namespace ringdown::radiate
