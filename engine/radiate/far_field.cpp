#include "engine/radiate/far_field.h"

#include "engine/modal/radiation_map.h"
#include "engine/radiate/lanes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <type_traits>

namespace ringdown::radiate {
namespace {

struct GaussPoint {
  double at, weight;
};

// Gauss's points and weights on -1 ... 1, by Newton's steps on Legendre's polynomial.
std::vector<GaussPoint> gauss_points(int count) {
  std::vector<GaussPoint> points;
  for (int i = 0; i < count; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5)), slope = 1;
    for (int step = 0; step < 100; ++step) {
      double before = 1, now = x;
      for (int l = 2; l <= count; ++l) {
        const double next = ((2 * l - 1) * x * now - (l - 1) * before) / l;
        before = now;
        now = next;
      }
      slope = count * (x * now - before) / (x * x - 1);
      const double change = now / slope;
      x -= change;
      if (std::abs(change) < 1e-15) break;
    }
    points.push_back({x, 2 / ((1 - x * x) * slope * slope)});
  }
  return points;
}

}  // namespace

Directions directions_for(int degree) {
  const std::vector<GaussPoint> heights = gauss_points(degree + 1);
  const int around = 2 * degree + 2;
  Directions directions{.degree = degree, .units = {}, .weights = {}};
  directions.units.resize((degree + 1) * around, 3);
  directions.weights.resize((degree + 1) * around);
  for (int h = 0; h <= degree; ++h) {
    const double z = heights[h].at, r = std::sqrt(1 - z * z);
    for (int a = 0; a < around; ++a) {
      const double phi = 2 * std::numbers::pi * (a + 0.5) / around;
      directions.units.row(h * around + a) << r * std::cos(phi), r * std::sin(phi), z;
      directions.weights[h * around + a] = heights[h].weight * 2 * std::numbers::pi / around;
    }
  }
  return directions;
}

std::vector<Eigen::Index> images_of(const Directions& directions, int image) {
  const int heights = directions.degree + 1, around = 2 * heights;
  std::vector<Eigen::Index> numbers;
  for (int h = 0; h < heights; ++h) {
    for (int a = 0; a < around; ++a) {
      int turned = a;
      if ((image & 1) != 0) turned = (around + around / 2 - 1 - turned) % around;
      if ((image & 2) != 0) turned = around - 1 - turned;
      numbers.push_back(static_cast<Eigen::Index>((image & 4) != 0 ? heights - 1 - h : h) * around + turned);
    }
  }
  return numbers;
}

int degree_for(double wavenumber_rad_m, double radius_m) {
  const double kr = wavenumber_rad_m * radius_m;
  const int degree = static_cast<int>(std::ceil(kr + 2.5 * std::cbrt(kr) + 3));
  return std::min(degree, modal::kMaxHarmonicDegree);
}

namespace {

// Computes exp(-ik y.d) for one direction, in single precision. The number of places must be a multiple of kLanes.
RINGDOWN_CLONES
void fill_waves(const float* x, const float* y, const float* z, Eigen::Index places, float kx, float ky, float kz,
                std::complex<float>* out) {
  for (Eigen::Index first = 0; first < places; first += kLanes) {
    Lanes px, py, pz, cosine, sine;
    std::memcpy(&px, x + first, sizeof px);
    std::memcpy(&py, y + first, sizeof py);
    std::memcpy(&pz, z + first, sizeof pz);
    exp_i(kx * px + ky * py + kz * pz, cosine, sine);
    for (int lane = 0; lane < kLanes; ++lane) out[first + lane] = {cosine[lane], -sine[lane]};
  }
}

// For each side and every layer, three components of the dipole and one simple source, from the mean of the side's
// ends. Rows beyond the sides are 0.
Eigen::MatrixXcd sources_of(const Panels& panels, double k, const std::vector<double>& coupling,
                            const Eigen::MatrixXcd& layers, Eigen::Index rows) {
  const std::complex<double> i(0, 1);
  const Eigen::Index modes = layers.cols();
  Eigen::MatrixXcd sources = Eigen::MatrixXcd::Zero(rows, 4 * modes);
  for (Eigen::Index s = 0; s < panels.side_count(); ++s) {
    const Side& side = panels.sides[s];
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double area = 0;
    for (const int t : side.triangles) {
      if (t < 0) continue;
      normal += panels.areas[t] / 3 * panels.normals[t];
      area += panels.areas[t] / 3;
    }
    const int a = side.nodes[0], b = side.nodes[1];
    for (Eigen::Index m = 0; m < modes; ++m) {
      const std::complex<double> mean = (layers(a, m) + layers(b, m)) / 2.0;
      for (int c = 0; c < 3; ++c) sources(s, 4 * m + c) = -i * k * normal[c] * mean;
      sources(s, 4 * m + 3) = -i * area * (coupling[a] * layers(a, m) + coupling[b] * layers(b, m)) / 2.0;
    }
  }
  return sources;
}

// Computes the fields by blocks of directions. Each block is the product of the exponentials at the middles of sides
// with the sources of the sides.
template <class Scalar>
Eigen::MatrixXcd sum_waves(const Eigen::MatrixXd& places, double k, const Directions& directions,
                           const Eigen::MatrixXcd& sources) {
  constexpr Eigen::Index kBlock = 64;
  using Matrix = Eigen::Matrix<std::complex<Scalar>, Eigen::Dynamic, Eigen::Dynamic>;
  const Matrix carried = sources.cast<std::complex<Scalar>>();
  const Eigen::MatrixXf single = places.cast<float>();
  const Eigen::Index count = directions.weights.size(), modes = sources.cols() / 4;
  Eigen::MatrixXcd fields(count, modes);
  Matrix waves(places.rows(), kBlock);
  for (Eigen::Index first = 0; first < count; first += kBlock) {
    const Eigen::Index size = std::min(kBlock, count - first);
    for (Eigen::Index d = 0; d < size; ++d) {
      const Eigen::Vector3d way = k * directions.units.row(first + d).transpose();
      if constexpr (std::is_same_v<Scalar, float>) {
        fill_waves(single.col(0).data(), single.col(1).data(), single.col(2).data(), places.rows(),
                   static_cast<float>(way[0]), static_cast<float>(way[1]), static_cast<float>(way[2]),
                   waves.col(d).data());
      } else {
        const Eigen::ArrayXd phase = -(places * way).array();
        waves.col(d).real() = phase.cos();
        waves.col(d).imag() = phase.sin();
      }
    }
    const Matrix sums = waves.leftCols(size).transpose() * carried;
    for (Eigen::Index m = 0; m < modes; ++m) {
      for (Eigen::Index d = 0; d < size; ++d) {
        std::complex<double> field(sums(d, 4 * m + 3));
        for (int c = 0; c < 3; ++c) field += directions.units(first + d, c) * std::complex<double>(sums(d, 4 * m + c));
        fields(first + d, m) = field / (4 * std::numbers::pi);
      }
    }
  }
  return fields;
}

}  // namespace

// Uses double precision if the body is small compared with the wave, where fields cancel and directions are few;
// otherwise single precision.
Eigen::MatrixXcd far_fields(const Panels& panels, const Eigen::Vector3d& origin, double wavenumber_rad_m,
                            const std::vector<double>& coupling, const Directions& directions,
                            const Eigen::MatrixXcd& layers) {
  constexpr int kSmallDegree = 12;
  const Eigen::Index rows = (panels.side_count() + kLanes - 1) / kLanes * kLanes;
  Eigen::MatrixXd places = Eigen::MatrixXd::Zero(rows, 3);
  for (int s = 0; s < panels.side_count(); ++s) places.row(s) = (panels.sides[s].middle - origin).transpose();
  const Eigen::MatrixXcd sources = sources_of(panels, wavenumber_rad_m, coupling, layers, rows);
  return directions.degree <= kSmallDegree ? sum_waves<double>(places, wavenumber_rad_m, directions, sources)
                                           : sum_waves<float>(places, wavenumber_rad_m, directions, sources);
}

Eigen::MatrixXcd harmonics_of(const Directions& directions, const mesh::Points& units, const Eigen::MatrixXcd& fields) {
  const int count = modal::harmonic_count(directions.degree);
  constexpr Eigen::Index kBlock = 64;
  Eigen::MatrixXf values(count, kBlock);
  Eigen::MatrixXcd sums = Eigen::MatrixXcd::Zero(count, fields.cols());
  for (Eigen::Index first = 0; first < directions.weights.size(); first += kBlock) {
    const Eigen::Index size = std::min(kBlock, directions.weights.size() - first);
    for (Eigen::Index d = 0; d < size; ++d) {
      const auto unit = units.row(first + d);
      modal::real_harmonics({unit[0], unit[1], unit[2]}, directions.degree,
                            std::span(values.col(d).data(), static_cast<std::size_t>(count)));
    }
    const Eigen::MatrixXd at = values.leftCols(size).cast<double>();
    const Eigen::MatrixXcd weighted =
        directions.weights.segment(first, size).asDiagonal() * fields.middleRows(first, size);
    const Eigen::MatrixXd re = at * weighted.real(), im = at * weighted.imag();
    sums.real() += re;
    sums.imag() += im;
  }
  return sums;
}

}  // namespace ringdown::radiate
