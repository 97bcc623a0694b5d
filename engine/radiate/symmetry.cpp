#include "engine/radiate/symmetry.h"

#include "engine/dense/decompositions.h"
#include "engine/radiate/panels.h"
#include "engine/radiate/surface_search.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace ringdown::radiate {
namespace {

constexpr int kMaxSamples = 800;
constexpr double kAlike = 0.03;  // relative difference of two moments; below, their axes are arbitrary in their plane

using Vector = Eigen::Vector3d;

// Measures the distance of a surface's mirror image from the surface.
class MirrorTrial {
 public:
  explicit MirrorTrial(const Panels& panels) : panels_(panels), search_(panels) {
    area_ = panels.area();
    for (int t = 0; t < panels.triangle_count(); ++t) middle_ += panels.areas[t] / area_ * panels.centers[t];
    for (int t = 0; t < panels.triangle_count(); ++t) {
      Eigen::Matrix3d corners;
      for (int i = 0; i < 3; ++i) corners.col(i) = panels.corner(t, i) - middle_;
      const Vector sum = corners.rowwise().sum();
      moments_ += panels.areas[t] / 12 * (corners * corners.transpose() + sum * sum.transpose());
    }
    step_ = std::max(1, panels.triangle_count() / kMaxSamples);
    max_ = kMirrorDistance + roughness() / radius();
  }

  [[nodiscard]] const Panels& panels() const { return panels_; }
  [[nodiscard]] const Vector& middle() const { return middle_; }
  [[nodiscard]] const Eigen::Matrix3d& moments() const { return moments_; }

  // The largest distance at which a plane counts.
  [[nodiscard]] double max() const { return max_; }

  // Rms distance over the radius of a sphere of equal area. Infinite when far above most().
  [[nodiscard]] double distance(const Vector& normal) const {
    constexpr double kFar = 100;
    const double far = kFar * max_ * radius(), max = far * far * area_ / step_;
    double squares = 0, area = 0;
    for (int t = 0; t < panels_.triangle_count(); t += step_) {
      const Vector away = panels_.centers[t] - middle_, facing = panels_.normals[t];
      const Vector image = panels_.centers[t] - 2 * away.dot(normal) * normal;
      const NearestPoint place = search_.nearest(image, facing - 2 * facing.dot(normal) * normal);
      squares += panels_.areas[t] * (place.at - image).squaredNorm();
      area += panels_.areas[t];
      if (squares > max) return std::numeric_limits<double>::infinity();
    }
    return std::sqrt(squares / area) / radius();
  }

 private:
  [[nodiscard]] double radius() const { return std::sqrt(area_ / (4 * std::numbers::pi)); }

  // The rms distance of flat triangles from the curved surface that they approximate: an arc of length h that turns by
  // a small angle lies h / 8 times that angle above its chord.
  [[nodiscard]] double roughness() const {
    constexpr double kSharp = 0.7;  // [rad]; larger angles are edges of the body
    std::vector<double> off(panels_.triangle_count(), 0);
    for (const Side& side : panels_.sides) {
      const double length = (panels_.nodes.row(side.nodes[0]) - panels_.nodes.row(side.nodes[1])).norm();
      const double cosine = panels_.normals[side.triangles[0]].dot(panels_.normals[side.triangles[1]]);
      const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
      if (angle > kSharp) continue;
      for (const int t : side.triangles) off[t] = std::max(off[t], 2 * panels_.areas[t] / length * angle / 8);
    }
    double squares = 0;
    for (int t = 0; t < panels_.triangle_count(); ++t) squares += panels_.areas[t] * off[t] * off[t];
    return std::sqrt(squares / area_);
  }

  const Panels& panels_;
  SurfaceSearch search_;
  Vector middle_ = Vector::Zero();
  Eigen::Matrix3d moments_ = Eigen::Matrix3d::Zero();
  double area_ = 0, max_ = 0;
  int step_ = 1;
};

// Returns the normals of the few largest faces; opposite normals count as one. Directions are first sorted into the
// cells of a grid. If a face has triangles in several cells, its area is that of all triangles along the largest cell's
// mean.
std::vector<Vector> face_normals(const Panels& panels) {
  constexpr double kCosFace = 0.9998, kCell = 0.02;
  constexpr int kFaces = 6, kCells = 4 * kFaces;
  std::map<std::array<int, 3>, Vector> cells;  // area times normal
  for (int t = 0; t < panels.triangle_count(); ++t) {
    Vector normal = panels.normals[t];
    Eigen::Index largest = 0;
    normal.cwiseAbs().maxCoeff(&largest);
    if (normal[largest] < 0) normal = -normal;
    std::array<int, 3> cell{};
    for (int c = 0; c < 3; ++c) cell[c] = static_cast<int>(std::lround(normal[c] / kCell));
    cells.try_emplace(cell, Vector::Zero()).first->second += panels.areas[t] * normal;
  }
  std::vector<Vector> sums;
  for (const auto& [cell, sum] : cells) sums.push_back(sum);
  const auto kept = std::min<std::ptrdiff_t>(kCells, std::ssize(sums));
  std::partial_sort(sums.begin(), sums.begin() + kept, sums.end(),
                    [](const Vector& a, const Vector& b) { return a.norm() > b.norm(); });
  sums.resize(kept);
  std::vector<Vector> largest;
  for (const Vector& sum : sums) {
    const Vector normal = sum.normalized();
    const auto faces = [&](const Vector& other) { return std::abs(other.dot(normal)) > kCosFace; };
    if (std::ssize(largest) == kFaces) break;
    if (std::any_of(largest.begin(), largest.end(), faces)) continue;
    double area = 0;
    for (int t = 0; t < panels.triangle_count(); ++t) area += faces(panels.normals[t]) ? panels.areas[t] : 0;
    if (area >= 0.02 * panels.area()) largest.push_back(normal);
  }
  return largest;
}

// The best mirror plane whose normal lies in the plane of `first` and `second`, within `half` [rad] of the normal at
// `angle`.
Vector best_around(const MirrorTrial& trial, const Vector& first, const Vector& second, double angle, double half) {
  const auto at = [&](double a) -> Vector { return std::cos(a) * first + std::sin(a) * second; };
  for (; half > 1e-4; half /= 2) {
    const double low = trial.distance(at(angle - half / 2)), middle = trial.distance(at(angle)),
                 high = trial.distance(at(angle + half / 2));
    if (low < middle && low <= high) angle -= half / 2;
    if (high < middle && high < low) angle += half / 2;
  }
  return at(angle);
}

std::vector<Vector> candidates(const MirrorTrial& trial) {
  std::vector<Vector> found = {Vector::UnitX(), Vector::UnitY(), Vector::UnitZ()};
  const dense::Spectrum3 principal = dense::spectrum_of_3(trial.moments());
  for (int i = 0; i < 3; ++i) found.emplace_back(principal.vectors.col(i));
  for (const Vector& normal : face_normals(trial.panels())) found.push_back(normal);
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d& values = principal.values;
    const Eigen::Matrix3d& axes = principal.vectors;
    if (values[i + 1] - values[i] > kAlike * values[i + 1]) continue;
    constexpr int kSteps = 36;
    double best = std::numeric_limits<double>::infinity(), at = 0;
    for (int step = 0; step < kSteps; ++step) {
      const double angle = std::numbers::pi * step / kSteps;
      const double distance = trial.distance(std::cos(angle) * axes.col(i) + std::sin(angle) * axes.col(i + 1));
      if (distance < best) {
        best = distance;
        at = angle;
      }
    }
    if (!std::isfinite(best)) continue;
    const Vector normal = best_around(trial, axes.col(i), axes.col(i + 1), at, std::numbers::pi / kSteps);
    found.push_back(normal);
    found.emplace_back(normal.cross(axes.col(i == 0 ? 2 : 0)).normalized());
  }
  return found;
}

}  // namespace

// Chooses the best plane first, then the best among the planes perpendicular to it. These are made exactly
// perpendicular.
Symmetry symmetry_of(const mesh::TriangleMesh& surface) {
  Symmetry symmetry;
  const auto panels = panels_of(surface);
  if (!panels) return symmetry;
  const MirrorTrial trial(*panels);
  std::vector<Vector> normals, left = candidates(trial);
  while (normals.size() < 3) {
    constexpr double kBetter = 0.8;  // of similar planes, the first is chosen, on which elements have their nodes
    double best = trial.max() / kBetter;
    Vector chosen = Vector::Zero();
    for (const Vector& normal : left) {
      const double distance = trial.distance(normal);
      if (distance < kBetter * best) {
        best = distance;
        chosen = normal;
      }
    }
    if (chosen.isZero()) break;
    normals.push_back(chosen);
    std::vector<Vector> others;
    for (const Vector& normal : left) {
      const double along = normal.dot(chosen);
      if (std::abs(along) < 0.05) others.push_back((normal - along * chosen).normalized());
    }
    if (normals.size() == 2) others.push_back(normals[0].cross(normals[1]));
    left = std::move(others);
  }
  symmetry.mirrors = static_cast<int>(normals.size());
  if (normals.empty()) return symmetry;
  if (normals.size() == 1) normals.push_back(normals[0].unitOrthogonal());
  if (normals.size() == 2) normals.push_back(normals[0].cross(normals[1]));
  if (normals[0].cross(normals[1]).dot(normals[2]) < 0) normals[2] = -normals[2];
  for (int axis = 0; axis < 3; ++axis) symmetry.turn.row(axis) = normals[axis].transpose();
  symmetry.shift.head(symmetry.mirrors) = (symmetry.turn * trial.middle()).head(symmetry.mirrors);
  return symmetry;
}

Body moved(const Body& body, const Symmetry& symmetry) {
  Body other = body;
  const Eigen::RowVector3d shift = symmetry.shift.transpose();
  other.surface.nodes = (body.surface.nodes * symmetry.turn.transpose()).rowwise() - shift;
  other.flow.positions = (body.flow.positions * symmetry.turn.transpose()).rowwise() - shift;
  other.flow.normals = body.flow.normals * symmetry.turn.transpose();
  return other;
}

}  // namespace ringdown::radiate
