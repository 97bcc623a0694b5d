#include "engine/bake/sample_points.h"

#include "engine/base/triangle.h"
#include "engine/mesh/coarsen.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <utility>

// Fewer points until the error is met
//
// All nodes of the surface are taken first. Then points are removed, those that cost least first; the shapes are fitted
// to those that are left and their errors measured. The error of linear interpolation goes as one over the number of
// points, which says how many to try next. When a set turns out to be too small, the last good one is taken up again,
// and the search ends between the two.
//
// Coarsening compares a few fields, not hundreds of modes: sums of all modes, each divided by its rms and taken
// with a random sign. The expected square of what such a sum loses is the sum of the squares of what the modes lose
// (Johnson & Lindenstrauss, 1984).
namespace ringdown::bake {
namespace {

using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using ByRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Factor = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>;
using Indicators = std::vector<Eigen::Triplet<double>>;

constexpr Eigen::Index kSums = 8;          // random sums of modes, of three components each
constexpr Eigen::Index kModesAtOnce = 64;  // bounds the memory of a fit
constexpr int kRegions = 20;
constexpr double kWorstShare = 10.0 / 3;  // error allowed to one mode, over that of the median
constexpr double kMaxVolumeError = 0.01;
constexpr double kWantedAngle_deg = 20;
constexpr double kMargin = 0.88;                // fitted values are a little nearer at the samples than elsewhere
constexpr std::size_t kManyTriangles = 40'000;  // that get one sample each, fewer get three
constexpr double kPull = 0.02;         // of a point's share of the surface, towards the exact value at the point
constexpr double kDistanceUnit = 0.8;  // of the thickness: a distance that counts as much as a loss of the whole field

// One component, 0 to 2, of the shapes of `count` modes from `first` on: S x count.
Eigen::MatrixXd component(const Eigen::MatrixXd& shapes, int axis, Eigen::Index first, Eigen::Index count) {
  using Strided = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::Stride<Eigen::Dynamic, 3>>;
  return Strided(shapes.data() + first * shapes.rows() + axis, shapes.rows() / 3, count,
                 Eigen::Stride<Eigen::Dynamic, 3>(shapes.rows(), 3));
}

// factor.solve(right), rounded alike. Eigen's goes through the factor for every column by itself.
ByRows solved(const Factor& factor, const ByRows& right) {
  using Entry = Eigen::SparseMatrix<double>::InnerIterator;
  const Eigen::SparseMatrix<double>& lower = factor.matrixL().nestedExpression();
  ByRows values = factor.permutationP() * right;
  for (Eigen::Index k = 0; k < lower.cols(); ++k) {
    Entry entry(lower, k);  // the first of a column is the diagonal's
    values.row(k) /= entry.value();
    while (++entry) values.row(entry.index()) -= entry.value() * values.row(k);
  }
  for (Eigen::Index k = lower.cols() - 1; k >= 0; --k) {
    Entry entry(lower, k);
    const double diagonal = entry.value();
    while (++entry) values.row(k) -= entry.value() * values.row(entry.index());
    values.row(k) /= diagonal;
  }
  return factor.permutationPinv() * values;
}

mesh::SurfaceQuadrature samples_of(const mesh::Boundary& surface, const mesh::TetMesh& mesh) {
  return mesh::quadrature_of(surface, mesh, surface.triangles.size() < kManyTriangles ? 3 : 1);
}

// All nodes of the surface, with the shapes' own values. Removing no point takes none of the time that finding the
// cheapest point takes.
SamplePoints all_nodes(const mesh::TetMesh& mesh, const mesh::Boundary& surface, const Eigen::MatrixXd& shapes) {
  SamplePoints points{.positions = mesh.nodes(surface.nodes, Eigen::all),
                      .triangles = surface.triangles,
                      .shapes = shapes,
                      .errors = Eigen::VectorXd(shapes.cols())};
  const mesh::SurfaceQuadrature samples = samples_of(surface, mesh);
  const mesh::Points at = samples.interpolation * points.positions;
  const Eigen::Index share = at.rows() / static_cast<Eigen::Index>(surface.triangles.size());
  const auto place = [](const mesh::Points& list, Eigen::Index i) { return Vec3{list(i, 0), list(i, 1), list(i, 2)}; };
  Indicators entries;
  for (Eigen::Index s = 0; s < at.rows(); ++s) {
    const auto& t = surface.triangles[static_cast<std::size_t>(s / share)];
    const std::array<Vec3, 3> corners{place(points.positions, t[0]), place(points.positions, t[1]),
                                      place(points.positions, t[2])};
    const std::array<double, 3> weights = nearest_on_triangle(place(at, s), corners);
    for (std::size_t i = 0; i < 3; ++i) entries.emplace_back(s, t[i], weights[i]);
  }
  Sparse linear(at.rows(), points.positions.rows());
  linear.setFromTriplets(entries.begin(), entries.end());
  const Sparse off = samples.interpolation - linear;
  for (Eigen::Index m = 0; m < shapes.cols(); ++m) {
    double lost = 0, square = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::VectorXd moved = component(shapes, axis, m, 1);
      lost += samples.areas.dot((off * moved).cwiseAbs2());
      square += samples.areas.dot((samples.interpolation * moved).cwiseAbs2());
    }
    points.errors[m] = std::sqrt(lost / square);
  }
  return points;
}

// The surface in kRegions parts of equal area, each near in place and in direction: the two sides of a wall are apart.
Sparse choose_regions(const mesh::Points& positions, const mesh::SurfaceQuadrature& samples) {
  constexpr double kDirection = 0.25;  // of the body's length: how far apart opposite directions count
  const double length_m = (positions.colwise().maxCoeff() - positions.colwise().minCoeff()).norm();
  Eigen::MatrixXd place(positions.rows(), 6);
  place << positions, kDirection * length_m * samples.normals;
  std::vector<Eigen::Index> order(positions.rows());
  std::iota(order.begin(), order.end(), 0);
  Indicators members;
  const auto split = [&](const auto& self, auto first, auto last, int region, int count) -> void {
    if (count == 1) {
      for (auto i = first; i != last; ++i) members.emplace_back(region, *i, samples.areas[*i]);
      return;
    }
    Eigen::RowVectorXd low = place.row(*first), high = low;
    double area = 0;
    for (auto i = first; i != last; ++i) {
      low = low.cwiseMin(place.row(*i));
      high = high.cwiseMax(place.row(*i));
      area += samples.areas[*i];
    }
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    std::sort(first, last, [&](Eigen::Index a, Eigen::Index b) { return place(a, axis) < place(b, axis); });
    const int half = count / 2;
    double sum = 0;
    auto middle = first + 1;
    while (middle != last - 1 && (sum += samples.areas[*(middle - 1)]) * count < area * half) ++middle;
    self(self, first, middle, region, half);
    self(self, middle, last, region + half, count - half);
  };
  const int count = static_cast<int>(std::min<Eigen::Index>(kRegions, positions.rows()));
  split(split, order.begin(), order.end(), 0, count);
  Sparse regions(count, positions.rows());
  regions.setFromTriplets(members.begin(), members.end());
  return regions;
}

// Puts points back where fitting has made a triangle narrow.
void keep_wide(SamplePoints& points, const mesh::Points& exact) {
  constexpr int kMaxRounds = 10;
  const double narrow = std::cos((kWantedAngle_deg + 0.1) / 180 * std::numbers::pi);
  for (int round = 0; round < kMaxRounds; ++round) {
    std::set<std::uint32_t> back;
    for (const auto& t : points.triangles) {
      for (int i = 0; i < 3; ++i) {
        const Eigen::RowVector3d at = points.positions.row(t[i]);
        const Eigen::RowVector3d a = (points.positions.row(t[(i + 1) % 3]) - at).normalized();
        const Eigen::RowVector3d b = (points.positions.row(t[(i + 2) % 3]) - at).normalized();
        if (a.dot(b) > narrow) back.insert(t.begin(), t.end());
      }
    }
    for (const std::uint32_t p : back) points.positions.row(p) = exact.row(p);
  }
}

// Numbers the points anew, each followed by the nearest of those to come: what is near in place is near in the file,
// which makes compressed banks smaller by a tenth.
void put_in_a_chain(SamplePoints& points) {
  constexpr double kClearly = 1 - 1e-6;        // so that rounding does not choose among points at one distance
  constexpr Eigen::Index kMaxPoints = 20'000;  // the search for the nearest takes P^2 steps
  if (points.positions.rows() > kMaxPoints) return;
  std::vector<std::uint32_t> order(points.positions.rows());
  std::iota(order.begin(), order.end(), 0U);
  for (auto at = order.begin(); at + 1 < order.end(); ++at) {
    const Eigen::RowVector3d here = points.positions.row(*at);
    const auto distance = [&](std::uint32_t p) { return (points.positions.row(p) - here).squaredNorm(); };
    std::iter_swap(at + 1, std::min_element(at + 1, order.end(), [&](std::uint32_t a, std::uint32_t b) {
                     return distance(a) < kClearly * distance(b);
                   }));
  }
  const SamplePoints old = points;
  std::vector<std::uint32_t> number(order.size());
  for (std::uint32_t p = 0; p < order.size(); ++p) {
    number[order[p]] = p;
    points.positions.row(p) = old.positions.row(order[p]);
    points.shapes.middleRows<3>(3 * p) = old.shapes.middleRows<3>(3 * order[p]);
  }
  for (auto& [a, b, c] : points.triangles) {
    a = number[a];
    b = number[b];
    c = number[c];
  }
}

// Rounds to 22 binary places. A body of another size or stiffness has the same values but for their last bits, and then
// has exactly the same ones, so that the same points are removed. The grid lies off the halves that structured meshes
// have.
Eigen::MatrixXd on_grid(const Eigen::MatrixXd& values) {
  constexpr double kPlaces = 1 << 22, kOffHalves = 0.3819660113;
  return (values.array() * kPlaces + kOffHalves).round() / kPlaces;
}

double median(Eigen::VectorXd values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

struct Fit {
  SamplePoints points;
  double worst_region = 0;  // rms over the modes, each over its rms on the whole surface
  double volume_error = 0;

  // The error over the one that was asked for, by the measure that is worst; <= 1 when all is as it should be.
  [[nodiscard]] double excess(double shape_error) const {
    const double worst = std::max(points.errors.maxCoeff(), worst_region) / kWorstShare;
    return std::max(std::max(median(points.errors), worst) / (kMargin * shape_error), volume_error / kMaxVolumeError);
  }
};

class Chooser {
 public:
  Chooser(const mesh::TetMesh& mesh, const mesh::Boundary& surface, const Eigen::MatrixXd& shapes)
      : shapes_(shapes),
        samples_(samples_of(surface, mesh)),
        nodes_(static_cast<Eigen::Index>(surface.nodes.size()), 3),
        square_(Eigen::VectorXd::Zero(shapes.cols())) {
    for (Eigen::Index p = 0; p < nodes_.rows(); ++p) nodes_.row(p) = mesh.nodes.row(surface.nodes[p]);
    positions_ = samples_.interpolation * nodes_;
    area_ = samples_.areas.sum();
    volume_ = samples_.areas.dot(positions_.cwiseProduct(samples_.normals).rowwise().sum()) / 3;  // Gauss
    regions_ = choose_regions(positions_, samples_);
    for_modes([&](Eigen::Index first, Eigen::Index count) {
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::MatrixXd there = samples_.interpolation * component(shapes_, axis, first, count);
        square_.segment(first, count) += (samples_.areas.transpose() * there.cwiseAbs2()).transpose() / area_;
      }
    });
    coarsen(surface.triangles);
  }

  mesh::Coarsening& coarsening() { return *coarsening_; }

  // The points that are left, with the values that interpolate best.
  [[nodiscard]] Fit fit() const {
    const std::vector<std::array<std::uint32_t, 3>> triangles = coarsening_->triangles();
    const std::vector<Eigen::Index>& origins = coarsening_->origins();
    std::vector<Eigen::Index>
        from;  // of each point that is left: a row of what is known at nodes, or beyond, at samples
    std::vector<std::uint32_t> number(nodes_.rows(), 0);
    for (const auto& t : triangles) {
      for (const std::uint32_t p : t) number[p] = 1;
    }
    for (std::size_t p = 0; p < number.size(); ++p) {
      if (std::exchange(number[p], static_cast<std::uint32_t>(from.size())) == 1) from.push_back(origins[p]);
    }
    const auto count = static_cast<Eigen::Index>(from.size());
    Fit result;
    for (const auto& [a, b, c] : triangles) result.points.triangles.push_back({number[a], number[b], number[c]});
    const Sparse weights = weights_of(result.points.triangles, count);
    const Sparse weighted = Sparse(weights.transpose()) * samples_.areas.asDiagonal();
    const double pull = kPull * area_ / static_cast<double>(count);
    Eigen::SparseMatrix<double> normal = weighted * weights;
    for (Eigen::Index p = 0; p < count; ++p) normal.coeffRef(p, p) += pull;
    const Factor factor(normal);
    const auto exact = [&](const ByRows& at_nodes, const ByRows& at_samples) {
      ByRows values(count, at_nodes.cols());
      for (Eigen::Index p = 0; p < count; ++p) {
        const Eigen::Index row = from[p] - at_nodes.rows();
        values.row(p) = row < 0 ? at_nodes.row(from[p]) : at_samples.row(row);
      }
      return values;
    };
    const auto fitted = [&](const ByRows& at_nodes, const ByRows& at_samples) {
      return solved(factor, weighted * at_samples + pull * exact(at_nodes, at_samples));
    };

    result.points.positions = fitted(nodes_, positions_);
    keep_wide(result.points, exact(nodes_, positions_));
    result.volume_error = std::abs(volume_of(result.points) / volume_ - 1);
    result.points.shapes.resize(3 * count, shapes_.cols());
    Eigen::MatrixXd lost = Eigen::MatrixXd::Zero(regions_.rows(), shapes_.cols());
    for_modes([&](Eigen::Index first, Eigen::Index modes) {
      for (int axis = 0; axis < 3; ++axis) {
        const ByRows at_nodes = component(shapes_, axis, first, modes);
        const ByRows at_samples = samples_.interpolation * at_nodes;
        const ByRows values = fitted(at_nodes, at_samples);
        const ByRows squares = (at_samples - weights * values).cwiseAbs2();
        lost.middleCols(first, modes) += ByRows(regions_ * squares);
        for (Eigen::Index m = 0; m < modes; ++m) {
          for (Eigen::Index p = 0; p < count; ++p) result.points.shapes(3 * p + axis, first + m) = values(p, m);
        }
      }
    });
    const Eigen::MatrixXd relative = lost * (area_ * square_).cwiseInverse().asDiagonal();
    result.points.errors = relative.colwise().sum().transpose().cwiseSqrt();
    result.worst_region = std::sqrt(relative.rowwise().mean().maxCoeff() * static_cast<double>(regions_.rows()));
    return result;
  }

 private:
  template <class Work>
  void for_modes(const Work& work) const {
    for (Eigen::Index first = 0; first < shapes_.cols(); first += kModesAtOnce) {
      work(first, std::min(kModesAtOnce, shapes_.cols() - first));
    }
  }

  // N x P: values at the samples from those at the points.
  [[nodiscard]] Sparse weights_of(const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                  Eigen::Index points) const {
    const std::vector<mesh::SurfacePlace> places = coarsening_->places();
    Indicators entries;
    for (std::size_t s = 0; s < places.size(); ++s) {
      for (int i = 0; i < 3; ++i) {
        entries.emplace_back(s, triangles[places[s].triangle][i], places[s].weights[i]);
      }
    }
    Sparse weights(static_cast<Eigen::Index>(places.size()), points);
    weights.setFromTriplets(entries.begin(), entries.end());
    return weights;
  }

  [[nodiscard]] static double volume_of(const SamplePoints& points) {
    double sum = 0;
    for (const auto& [a, b, c] : points.triangles) {
      const Eigen::Vector3d x = points.positions.row(a), y = points.positions.row(b), z = points.positions.row(c);
      sum += x.dot(y.cross(z)) / 6;
    }
    return sum;
  }

  void coarsen(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
    std::mt19937 random(1);
    Eigen::MatrixXd signs(shapes_.cols(), kSums);
    for (double& sign : signs.reshaped()) sign = (random() & 1U) != 0 ? 1 : -1;
    signs.array().colwise() /= (square_.array() * static_cast<double>(shapes_.cols() * kSums)).sqrt();
    Eigen::MatrixXd sums(nodes_.rows(), 3 * kSums);
    for (int axis = 0; axis < 3; ++axis) {
      sums.middleCols(axis * kSums, kSums).setZero();
      for_modes([&](Eigen::Index first, Eigen::Index count) {
        sums.middleCols(axis * kSums, kSums) += component(shapes_, axis, first, count) * signs.middleRows(first, count);
      });
    }
    const double thickness_m = 2 * volume_ / area_;
    const double mean_area = area_ / static_cast<double>(samples_.areas.size());
    const Eigen::MatrixXd at_samples = samples_.interpolation * sums;
    coarsening_.emplace(on_grid(nodes_), triangles, on_grid(sums).transpose().cast<float>(),
                        mesh::SurfaceSamples{on_grid(positions_), on_grid(samples_.normals),
                                             mean_area * on_grid(samples_.areas / mean_area),
                                             on_grid(at_samples).transpose().cast<float>()},
                        kDistanceUnit * thickness_m);
  }

  const Eigen::MatrixXd& shapes_;
  mesh::SurfaceQuadrature samples_;
  mesh::Points nodes_, positions_;  // S x 3 of the surface's nodes, N x 3 of the samples
  Eigen::VectorXd square_;          // mean over the surface, of each mode
  Sparse regions_;                  // areas of the samples, in the row of their region
  double area_ = 0, volume_ = 0;
  std::optional<mesh::Coarsening> coarsening_;
};

}  // namespace

Result<SamplePoints> choose_points(const mesh::TetMesh& mesh, const mesh::Boundary& surface,
                                   const Eigen::MatrixXd& shapes, const PointRequest& request,
                                   const Progress& progress) {
  constexpr double kMin = 0.6, kMax = 0.96;  // of the points that a step leaves
  constexpr double kNear = 0.04;             // of the points: the search ends when fewer are in doubt
  const auto go_on = [&](double fraction) { return !progress || progress("finish", fraction); };
  if (request.points >= surface.nodes.size()) return all_nodes(mesh, surface, shapes);
  Chooser chooser(mesh, surface, shapes);
  mesh::Coarsening& left = chooser.coarsening();
  if (request.points > 0) {
    if (left.reduce_to(request.points) || left.reduce_to(request.points, true)) {
      SamplePoints points = chooser.fit().points;
      put_in_a_chain(points);
      return points;
    }
    return fail(ErrorKind::too_large, "the surface of {} points cannot be reduced to {}, only to {}; allow more points",
                surface.nodes.size(), request.points, left.point_count());
  }
  Fit good = chooser.fit();
  double excess = good.excess(request.shape_error);
  mesh::Coarsening good_left = left;
  std::size_t enough = left.point_count();  // the fewest points known to be enough, and how far the error is used up
  std::size_t too_few = 0;                  // the most points known to be too few
  double too_few_excess = 0;
  while (excess<kMax&& static_cast<double>(enough - too_few)> std::max(1.5, kNear * static_cast<double>(enough))) {
    if (!go_on(excess)) return fail_cancelled();
    const auto count = static_cast<double>(enough);
    double target = count * std::clamp(excess, kMin, kMax);
    if (too_few > 0) {  // the error between the two as a power of the number of points
      const double between = static_cast<double>(too_few) / count;
      const double slope = std::log(too_few_excess / excess) / -std::log(between);
      target = count * std::clamp(std::pow(excess, 1 / slope), 0.75 * between + 0.25, 0.25 * between + 0.75);
    }
    const bool all = left.reduce_to(std::clamp(static_cast<std::size_t>(target), too_few + 1, enough - 1));
    Fit fewer = chooser.fit();
    const double now = fewer.excess(request.shape_error);
    if (now > 1) {
      too_few = left.point_count();
      too_few_excess = now;
      left = mesh::Coarsening(good_left);
    } else {
      good = std::move(fewer);
      good_left = mesh::Coarsening(left);
      excess = now;
      enough = left.point_count();
    }
    if (!all) break;
  }
  put_in_a_chain(good.points);
  return std::move(good.points);
}

}  // namespace ringdown::bake
