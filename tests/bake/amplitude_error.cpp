#include "tests/bake/amplitude_error.h"

#include "engine/bake/body_modes.h"
#include "engine/modal/strike_map.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

namespace ringdown::test {
namespace {

Vec3 vec(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

// Columns: the normal and two tangents.
Eigen::Matrix3d directions(const Eigen::Vector3d& normal) {
  Eigen::Index min = 0;
  normal.cwiseAbs().minCoeff(&min);
  const Eigen::Vector3d tangent = normal.cross(Eigen::Vector3d::Unit(min)).normalized();
  Eigen::Matrix3d all;
  all << normal, tangent, normal.cross(tangent);
  return all;
}

// Frequency of a damped mode, written down anew: lambda - d^2 = omega^2, d = (alpha + beta lambda) / 2.
double damped_hz(double lambda, const modal::RayleighDamping& damping) {
  const double decay = (damping.alpha_per_s + damping.beta_s * lambda) / 2;
  return std::sqrt(std::max(lambda - decay * decay, 0.0)) / (2 * std::numbers::pi);
}

using Samples = Eigen::MatrixXf;  // 3N x modes: amplitudes by the three directions of each point

// What the engine makes of unit impulses.
Samples struck(const modal::Bank& bank, const std::vector<SkinPoint>& points) {
  const modal::StrikeMap map(std::make_shared<const modal::Bank>(bank));
  std::vector<double> amplitudes(bank.mode_count());
  Samples samples(3 * static_cast<Eigen::Index>(points.size()), static_cast<Eigen::Index>(bank.mode_count()));
  Eigen::Index row = 0;
  for (const SkinPoint& point : points) {
    const Eigen::Matrix3d along = directions(point.normal);
    for (const auto& direction : along.colwise()) {
      map.excite(vec(point.at_m), vec(direction), amplitudes);
      samples.row(row++) = Eigen::Map<const Eigen::RowVectorXd>(amplitudes.data(), samples.cols()).cast<float>();
    }
  }
  return samples;
}

Samples true_amplitudes(const std::vector<SkinPoint>& points, const Eigen::MatrixXd& shapes) {
  Samples samples(3 * static_cast<Eigen::Index>(points.size()), shapes.cols());
  Eigen::Index row = 0;
  for (const SkinPoint& point : points) {
    samples.middleRows<3>(row) = (directions(point.normal).transpose() * displacement(point, shapes)).cast<float>();
    row += 3;
  }
  return samples;
}

struct Pair {
  Eigen::Index bank, solution;
  double product;
};

// For each mode of the bank the mode of the solution that it is.
Result<std::vector<Eigen::Index>> partners(const modal::Bank& bank, const Solution& solution, const Samples& engine,
                                           const Samples& truth) {
  std::vector<Pair> pairs;
  for (Eigen::Index m = 0; m < engine.cols(); ++m) {
    const double hz = bank.frequency_hz[static_cast<std::size_t>(m)];
    const std::size_t before = pairs.size();
    for (Eigen::Index s = 0; s < truth.cols(); ++s) {
      if (std::abs(solution.frequency_hz[s] / hz - 1) > kSameFrequency) continue;
      pairs.push_back({m, s, std::abs(engine.col(m).cast<double>().dot(truth.col(s).cast<double>()))});
    }
    if (pairs.size() > before) continue;
    char text[160];
    std::snprintf(text, sizeof text, "%s: its mode at %.6f Hz is not in the solution, so the bank is of another body",
                  bank.name.c_str(), hz);
    return fail(ErrorKind::bad_input, text);
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.product > b.product; });
  std::vector<Eigen::Index> found(static_cast<std::size_t>(engine.cols()), -1);
  std::vector<bool> taken(static_cast<std::size_t>(truth.cols()));
  for (const Pair& pair : pairs) {
    if (found[static_cast<std::size_t>(pair.bank)] >= 0 || taken[static_cast<std::size_t>(pair.solution)]) continue;
    found[static_cast<std::size_t>(pair.bank)] = pair.solution;
    taken[static_cast<std::size_t>(pair.solution)] = true;
  }
  if (std::find(found.begin(), found.end(), -1) != found.end())
    return fail(ErrorKind::bad_input, bank.name + ": two of its modes are one mode of the solution");
  return found;
}

// Divides the points again and again at the median of what extends furthest: a coordinate of place or of the normal. A
// normal that turns over counts as half of the body's size.
std::vector<std::vector<std::size_t>> regions(const std::vector<SkinPoint>& points) {
  constexpr std::size_t kRegions = 32;
  Eigen::Matrix<double, 6, Eigen::Dynamic> features(6, static_cast<Eigen::Index>(points.size()));
  for (std::size_t p = 0; p < points.size(); ++p)
    features.col(static_cast<Eigen::Index>(p)) << points[p].at_m, points[p].normal;
  const Eigen::Vector3d size = features.topRows<3>().rowwise().maxCoeff() - features.topRows<3>().rowwise().minCoeff();
  features.bottomRows<3>() *= size.norm() / 4;
  std::vector<std::vector<std::size_t>> parts(1, std::vector<std::size_t>(points.size()));
  std::iota(parts[0].begin(), parts[0].end(), std::size_t{0});
  while (parts.size() < kRegions) {
    std::vector<std::vector<std::size_t>> halves;
    for (std::vector<std::size_t>& part : parts) {
      const auto inside = features(Eigen::all, part).eval();
      Eigen::Index longest = 0;
      (inside.rowwise().maxCoeff() - inside.rowwise().minCoeff()).maxCoeff(&longest);
      const auto middle = part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
      std::nth_element(part.begin(), middle, part.end(), [&](std::size_t a, std::size_t b) {
        return features(longest, static_cast<Eigen::Index>(a)) < features(longest, static_cast<Eigen::Index>(b));
      });
      halves.emplace_back(part.begin(), middle);
      halves.emplace_back(middle, part.end());
    }
    parts = std::move(halves);
  }
  return parts;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double mean_square(const Eigen::VectorXd& values) { return values.squaredNorm() / static_cast<double>(values.size()); }

}  // namespace

Result<Solution> kept_solution(const mesh::TetMesh& mesh, const modal::Material& material,
                               const bake::BakeOptions& options) {
  Solution solution{.mesh = mesh::to_order(mesh, fem::order_of(options.element)), .frequency_hz = {}, .shapes = {}};
  const double length_m = bake::characteristic_length(solution.mesh.nodes);
  const mesh::TetMesh unit_mesh{solution.mesh.nodes / length_m, solution.mesh.elements};
  const bake::BodyUnits units{length_m, material.youngs_modulus_pa, material.density_kg_m3};
  const bake::BodyQuestion question{unit_mesh, CurvedSkin(solution.mesh).nodes().size(), options.element,
                                    material.poisson_ratio, solve::EigenRequest{}.tolerance};
  const double top = modal::highest_lambda_in_band(options.band_high_hz, material.damping) / units.lambda();
  const auto modes = bake::ModeCache(ContentCache(options.cache)).find(question, top, options.max_modes);
  if (!modes) return fail(ErrorKind::bad_input, "the cache " + options.cache.string() + " does not hold its modes");
  solution.frequency_hz.resize(modes->lambda.size());
  for (Eigen::Index m = 0; m < modes->lambda.size(); ++m)
    solution.frequency_hz[m] = damped_hz(units.lambda() * modes->lambda[m], material.damping);
  solution.shapes = modes->shapes / std::sqrt(material.density_kg_m3 * length_m * length_m * length_m);
  return solution;
}

Result<AmplitudeErrors> amplitude_errors(const modal::Bank& bank, const Solution& solution,
                                         const AmplitudeSampling& sampling) {
  const CurvedSkin skin(solution.mesh);
  std::vector<SkinPoint> points;
  for (int seed = 1; seed <= sampling.seeds; ++seed) {
    const std::vector<SkinPoint> more = skin.random_points(sampling.points, static_cast<std::uint64_t>(seed));
    points.insert(points.end(), more.begin(), more.end());
  }
  Samples engine = struck(bank, points);
  const Samples truth = true_amplitudes(points, solution.shapes);
  const auto found = partners(bank, solution, engine, truth);
  if (!found) return fail(found.error());

  const std::vector<std::vector<std::size_t>> parts = regions(points);
  Eigen::MatrixXd by_region(static_cast<Eigen::Index>(parts.size()), engine.cols());  // errors of modes
  AmplitudeErrors errors;
  for (Eigen::Index m = 0; m < engine.cols(); ++m) {
    const Eigen::VectorXd right = truth.col((*found)[static_cast<std::size_t>(m)]).cast<double>();
    Eigen::VectorXd given = engine.col(m).cast<double>();
    if (given.dot(right) < 0) given = -given;
    const Eigen::VectorXd off = given - right;
    const double unit = mean_square(right);
    errors.by_mode.push_back(std::sqrt(mean_square(off) / unit));
    for (std::size_t r = 0; r < parts.size(); ++r) {
      double sum = 0;
      for (const std::size_t p : parts[r]) sum += off.segment<3>(3 * static_cast<Eigen::Index>(p)).squaredNorm();
      by_region(static_cast<Eigen::Index>(r), m) = std::sqrt(sum / (3.0 * static_cast<double>(parts[r].size())) / unit);
    }
  }
  errors.median = median(errors.by_mode);
  errors.largest = *std::max_element(errors.by_mode.begin(), errors.by_mode.end());
  for (std::size_t r = 0; r < parts.size(); ++r) {
    const Eigen::VectorXd modes = by_region.row(static_cast<Eigen::Index>(r));
    errors.worst_region_median = std::max(errors.worst_region_median, median({modes.begin(), modes.end()}));
    const double rms = std::sqrt(mean_square(modes));
    if (rms <= errors.worst_region) continue;
    errors.worst_region = rms;
    errors.worst_place.setZero();
    for (const std::size_t p : parts[r]) errors.worst_place += points[p].at_m / static_cast<double>(parts[r].size());
  }
  return errors;
}

}  // namespace ringdown::test
