#include "engine/tube/mouth.h"

#include "engine/base/in_parallel.h"
#include "engine/radiate/far_field.h"
#include "engine/radiate/surface_pressure.h"
#include "engine/radiate/wave_band.h"
#include "engine/radiate/wave_solver.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace ringdown::tube {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kShown = 5;  // radii of the tube that stand in the air
constexpr int kAround = 64;
constexpr double kCoarser = 2;          // nodes of the finer skin over those of the coarser
constexpr double kExtrapolation = 0.5;  // of the step from the coarser skin to the finer

// The closed tube. Its polygon has the area of the circle.
mesh::TriangleMesh closed_tube(const MouthPlace& place) {
  const double step = 2 * kPi / kAround, radius = place.radius * std::sqrt(step / std::sin(step));
  const double length = std::min(place.length, kShown * place.radius);
  const int rows = std::max(2, static_cast<int>(std::lround(length / (step * radius) / 2)));
  const Vector3d across = place.axis.unitOrthogonal(), other = place.axis.cross(across);
  mesh::TriangleMesh tube;
  tube.nodes.resize(kAround * (rows + 1) + 2, 3);
  for (int row = 0; row <= rows; ++row) {
    for (int i = 0; i < kAround; ++i) {
      const double angle = step * (i + 0.5 * (row % 2));
      tube.nodes.row(row * kAround + i) = (place.middle + length * row / rows * place.axis +
                                           radius * (std::cos(angle) * across + std::sin(angle) * other))
                                              .transpose();
    }
  }
  const Index lid = tube.nodes.rows() - 2, end = lid + 1;
  tube.nodes.row(lid) = place.middle.transpose();
  tube.nodes.row(end) = (place.middle + length * place.axis).transpose();
  tube.triangles.resize(2 * kAround * (rows + 1), 3);
  Index t = 0;
  const auto add = [&](Index a, Index b, Index c) {
    tube.triangles.row(t++) << static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), static_cast<std::int32_t>(c);
  };
  for (int i = 0; i < kAround; ++i) {
    const int next = (i + 1) % kAround;
    add(lid, next, i);
    add(end, rows * kAround + i, rows * kAround + next);
    for (int row = 0; row < rows; ++row) {
      const int a = row * kAround, b = a + kAround;
      if (row % 2 == 0) {
        add(a + i, a + next, b + i);
        add(a + next, b + next, b + i);
      } else {
        add(a + i, a + next, b + next);
        add(a + i, b + next, b + i);
      }
    }
  }
  return tube;
}

// Samples of the lid: rings of equal area, each piece of it moved by 1 out of the tube.
radiate::FlowSamples lid_samples(const MouthPlace& place) {
  constexpr Index kRings = 12;
  const Vector3d across = place.axis.unitOrthogonal(), other = place.axis.cross(across);
  radiate::FlowSamples samples;
  samples.positions.resize(kRings * kAround, 3);
  samples.normals.resize(kRings * kAround, 3);
  samples.areas.setConstant(kRings * kAround, kPi * place.radius * place.radius / (kRings * kAround));
  for (Index ring = 0; ring < kRings; ++ring) {
    const double radius = place.radius * std::sqrt((ring + 0.5) / kRings);
    for (Index i = 0; i < kAround; ++i) {
      const double angle = 2 * kPi * (i + 0.5) / kAround;
      const Index row = ring * kAround + i;
      samples.positions.row(row) =
          (place.middle + radius * (std::cos(angle) * across + std::sin(angle) * other)).transpose();
      samples.normals.row(row) = -place.axis.transpose();
    }
  }
  return samples;
}

// Returns body and tube as one body; the flow of the lid is the last column.
radiate::Body together(const radiate::Body& body, const MouthPlace& place) {
  const mesh::TriangleMesh tube = closed_tube(place);
  const radiate::FlowSamples lid = lid_samples(place);
  const Index nodes = body.surface.nodes.rows(), triangles = body.surface.triangles.rows();
  const Index samples = body.flow.areas.size(), more = lid.areas.size(), modes = body.flow.flow.cols();
  radiate::Body both;
  both.surface.nodes.resize(nodes + tube.nodes.rows(), 3);
  both.surface.nodes << body.surface.nodes, tube.nodes;
  both.surface.triangles.resize(triangles + tube.triangles.rows(), 3);
  both.surface.triangles << body.surface.triangles,
      (tube.triangles.array() + static_cast<std::int32_t>(nodes)).matrix();
  both.flow.positions.resize(samples + more, 3);
  both.flow.positions << body.flow.positions, lid.positions;
  both.flow.normals.resize(samples + more, 3);
  both.flow.normals << body.flow.normals, lid.normals;
  both.flow.areas.resize(samples + more);
  both.flow.areas << body.flow.areas, lid.areas;
  both.flow.flow = Eigen::MatrixXf::Zero(samples + more, modes + 1);
  both.flow.flow.topLeftCorner(samples, modes) = body.flow.flow;
  both.flow.flow.col(modes).tail(more) = lid.areas.cast<float>();
  return both;
}

// A closed tube and a closed body are apart if no sample of the tube lies in the body, nor a node of the body in the
// tube.
bool are_apart(const radiate::Body& body, const MouthPlace& place) {
  for (Index n = 0; n < body.surface.nodes.rows(); ++n) {
    const Vector3d from = body.surface.nodes.row(n).transpose() - place.middle;
    const double along = from.dot(place.axis);
    if (along > 0 && along < place.length && (from - along * place.axis).norm() < place.radius) return false;
  }
  // The solid angle that the body fills around points of the tube's skin (van Oosterom & Strackee 1983).
  const mesh::TriangleMesh tube = closed_tube(place);
  for (Index n = 0; n < tube.nodes.rows(); n += 8) {
    double halves = 0;
    for (Index t = 0; t < body.surface.triangles.rows(); ++t) {
      const auto corner = [&](int i) -> Vector3d {
        return body.surface.nodes.row(body.surface.triangles(t, i)).transpose() - tube.nodes.row(n).transpose();
      };
      const Vector3d a = corner(0), b = corner(1), c = corner(2);
      const double la = a.norm(), lb = b.norm(), lc = c.norm();
      halves += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    }
    if (halves > kPi) return false;
  }
  return true;
}

}  // namespace

Result<Mouth> Mouth::of(const radiate::Body& body, const MouthPlace& place, int nodes) {
  if (!are_apart(body, place))
    return fail(ErrorKind::bad_input, "the tube and the body cut each other; move the mouth away from the body");
  const radiate::Body both = together(body, place);
  const Result<radiate::Original> original = radiate::Original::of(both);
  if (!original) return fail(original);
  Mouth mouth(place, (both.surface.nodes.rowwise() - place.middle.transpose()).rowwise().norm().maxCoeff());
  for (const double count : {nodes / kCoarser, static_cast<double>(nodes)}) {
    Result<radiate::Skin> skin = radiate::skin_of(*original, std::sqrt(original->panels->area() / (0.866 * count)));
    if (!skin) return fail(skin);
    Grid grid{.skin = std::move(*skin), .lid = {}};
    const radiate::Panels& panels = grid.skin.panels;
    for (int t = 0; t < panels.triangle_count(); ++t) {
      const Vector3d from = panels.centers[t] - place.middle;
      const double along = from.dot(place.axis);
      if (panels.normals[t].dot(place.axis) < -0.8 && std::abs(along) < 0.2 * place.radius &&
          (from - along * place.axis).norm() < place.radius)
        grid.lid.push_back(t);
    }
    if (grid.lid.empty())
      return fail(ErrorKind::bad_input, "the tube is too narrow beside the body for boundary elements");
    mouth.grids_.push_back(std::move(grid));
  }
  return mouth;
}

Mouth::Fields Mouth::fields_on(const Grid& grid, double k, const Eigen::Vector3d& origin, int threads) const {
  const radiate::Skin& skin = grid.skin;
  const std::vector<double> coupling = radiate::coupling_of(skin, k);
  radiate::ClassMatrices matrices;
  radiate::class_matrices(skin, k, coupling, matrices, threads);
  const Eigen::MatrixXcd layers =
      radiate::LuFactors(matrices[0]).solve(skin.flow[0].cast<std::complex<float>>()).cast<Complex>();
  Eigen::MatrixXcd at(static_cast<Index>(grid.lid.size()), layers.cols());
  Eigen::VectorXd areas(at.rows());
  const radiate::SurfacePressure pressure({&skin.panels, 1}, 0, k, coupling, layers);
  in_parallel(threads, [&](int thread) {
    for (Index t = thread; t < at.rows(); t += threads) {
      at.row(t) = pressure.at(grid.lid[t]);
      areas[t] = skin.panels.areas[grid.lid[t]];
    }
  });
  const Eigen::RowVectorXcd means = areas.cast<Complex>().transpose() * at / areas.sum();
  const Index modes = layers.cols() - 1;
  const double reach = reach_ + (origin - place_.middle).norm();
  const radiate::Directions directions = radiate::directions_for(radiate::degree_for(k, reach));
  const Eigen::MatrixXcd field = radiate::far_fields(skin.panels, origin, k, coupling, directions, layers.rightCols(1));
  return {means[modes], means.head(modes).transpose(), radiate::harmonics_of(directions, directions.units, field)};
}

MouthAnswer Mouth::at(double wavenumber_rad_m, const Eigen::Vector3d& origin, int threads) const {
  const int count = thread_count(threads);
  const Fields coarse = fields_on(grids_[0], wavenumber_rad_m, origin, count);
  const Fields fine = fields_on(grids_[1], wavenumber_rad_m, origin, count);
  const Eigen::VectorXcd harmonics = fine.harmonics + kExtrapolation * (fine.harmonics - coarse.harmonics);
  MouthAnswer answer;
  // The energy that the lid radiates: -S Im A = k times the integral of |F|^2.
  const double area = kPi * place_.radius * place_.radius;
  answer.outside.end_m = {fine.end.real() + kExtrapolation * (fine.end.real() - coarse.end.real()),
                          -wavenumber_rad_m * harmonics.squaredNorm() / area};
  answer.outside.wavenumber_rad_m = wavenumber_rad_m;
  answer.from_body = fine.from_body + kExtrapolation * (fine.from_body - coarse.from_body);
  answer.field.assign(harmonics.begin(), harmonics.end());
  answer.end_error_m = kExtrapolation * std::abs(fine.end.real() - coarse.end.real());
  Index largest = 0;
  const double bond = answer.from_body.size() > 0 ? answer.from_body.cwiseAbs().maxCoeff(&largest) : 0;
  if (bond > 0)
    answer.bond_error = kExtrapolation * std::abs(fine.from_body[largest] - coarse.from_body[largest]) / bond;
  return answer;
}

}  // namespace ringdown::tube
