#include "tests/radiate/surface_power.h"

#include "engine/radiate/near_integrals.h"
#include "engine/radiate/surface_search.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace ringdown::radiate {
namespace {

using Complex = std::complex<double>;

// What the three hat functions of a triangle send to a point, as double layers minus i eta times simple ones. Near the
// point the static part is exact, and what the wave adds to it is summed over the middles of sides like all far away.
std::array<Complex, 3> sent_to(const Panels& panels, int triangle, const Eigen::Vector3d& point, double k,
                               const std::vector<double>& coupling, bool near) {
  std::array<Complex, 3> doubles{}, simples{};
  const Eigen::Vector3d& normal = panels.normals[triangle];
  for (int e = 0; e < 3; ++e) {  // opposite of corner e; the hat functions of the other two are 1/2
    const Eigen::Vector3d away = panels.sides[panels.sides_of[triangle][e]].middle - point;
    const double r = away.norm(), weight = panels.areas[triangle] / 6;
    const Complex wave = std::polar(1.0, k * r);
    const Complex simple = (near ? wave - 1.0 : wave) / r;
    const Complex slope = (wave * Complex(-1, k * r) + (near ? 1.0 : 0.0)) / (r * r * r) * away.dot(normal);
    for (const int i : {(e + 1) % 3, (e + 2) % 3}) {
      simples[i] += weight * simple;
      doubles[i] += weight * slope;
    }
  }
  if (near) {
    const TrianglePotential potential = potential_of(panels, triangle, point);
    for (int i = 0; i < 3; ++i) {
      simples[i] += potential.value[i];
      // On the triangle itself, half of the jump of the double layer remains.
      doubles[i] += (point == panels.centers[triangle]) ? 2 * std::numbers::pi / 3 : -potential.gradient[i].dot(normal);
    }
  }
  std::array<Complex, 3> sums;
  for (int i = 0; i < 3; ++i) {
    const double eta = coupling[panels.corners[triangle][i]];
    sums[i] = (doubles[i] - Complex(0, eta) * simples[i]) / (4 * std::numbers::pi);
  }
  return sums;
}

// u at the middle of each triangle, outside: T x M.
Eigen::MatrixXcd outside(const Panels& panels, double k, const std::vector<double>& coupling,
                         const Eigen::MatrixXcd& layers) {
  Eigen::MatrixXcd values = Eigen::MatrixXcd::Zero(panels.triangle_count(), layers.cols());
  Eigen::RowVectorXcd row(panels.node_count());
  std::vector<double> reach;
  for (int t = 0; t < panels.triangle_count(); ++t) reach.push_back(kNearSides * panels.longest_side(t));
  for (int x = 0; x < panels.triangle_count(); ++x) {
    row.setZero();
    for (int y = 0; y < panels.triangle_count(); ++y) {
      const bool near = (panels.centers[x] - panels.centers[y]).norm() < std::max(reach[x], reach[y]);
      const auto sent = sent_to(panels, y, panels.centers[x], k, coupling, near);
      for (int i = 0; i < 3; ++i) row[panels.corners[y][i]] += sent[i];
    }
    values.row(x) = row * layers;
  }
  return values;
}

}  // namespace

Eigen::MatrixXd triangle_flow(const Panels& panels, const FlowSamples& samples) {
  const SurfaceSearch search(panels);
  Eigen::MatrixXd flow = Eigen::MatrixXd::Zero(panels.triangle_count(), samples.flow.cols());
  for (Eigen::Index s = 0; s < samples.positions.rows(); ++s) {
    const NearestPoint place = search.nearest(samples.positions.row(s).transpose(), samples.normals.row(s).transpose());
    flow.row(place.triangle) += samples.flow.row(s).cast<double>();
  }
  return flow;
}

std::vector<SurfacePower> surface_power(const Panels& panels, double wavenumber_rad_m,
                                        const std::vector<double>& coupling, const Eigen::MatrixXcd& layers,
                                        const Eigen::MatrixXd& flow, const modal::Air& air) {
  const Eigen::MatrixXcd values = outside(panels, wavenumber_rad_m, coupling, layers);
  std::vector<SurfacePower> powers;
  const double omega = wavenumber_rad_m * air.sound_speed_m_s;
  for (Eigen::Index m = 0; m < layers.cols(); ++m) {
    const Complex sum = (values.col(m).array() * flow.col(m).array()).sum();
    powers.push_back({-0.5 * air.density_kg_m3 * omega * sum.imag(), std::abs(sum.imag()) / std::abs(sum)});
  }
  return powers;
}

}  // namespace ringdown::radiate
