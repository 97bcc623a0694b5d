#include "engine/fit/identification.h"

#include "engine/dense/decompositions.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace ringdown::fit {
namespace {

constexpr double kCentsPerNeper = 1200 / std::numbers::ln2;

// A baked frequency and the heard one that is nearest to it.
struct Pair {
  std::size_t baked;
  double off;  // ln of heard over baked, the tuning included
};

std::vector<Pair> pairs_of(std::span<const double> heard_hz, const Slopes& slopes, const DetermineOptions& options) {
  const double tuning = options.tuning_cents / kCentsPerNeper, tolerance = options.tolerance_cents / kCentsPerNeper;
  std::vector<Pair> pairs;
  std::vector<bool> taken(slopes.frequency_hz.size());
  std::vector<std::pair<double, Pair>> candidates;  // by distance, so that the closest pairs come first
  for (const double heard : heard_hz) {
    for (std::size_t b = 0; b < slopes.frequency_hz.size(); ++b) {
      const double off = std::log(heard / slopes.frequency_hz[b]);
      if (std::abs(off - tuning) <= tolerance) candidates.push_back({heard, {b, off}});
    }
  }
  std::ranges::stable_sort(candidates, {}, [&](const auto& c) { return std::abs(c.second.off - tuning); });
  std::vector<double> used;
  for (const auto& [heard, pair] : candidates) {
    if (taken[pair.baked] || std::ranges::find(used, heard) != used.end()) continue;
    taken[pair.baked] = true;
    used.push_back(heard);
    pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace

Result<Determined> determine(std::span<const double> heard_hz, const Slopes& slopes, const DetermineOptions& options) {
  const std::vector<Pair> pairs = pairs_of(heard_hz, slopes, options);
  const auto n = static_cast<Eigen::Index>(pairs.size()), figures = 1 + std::ssize(slopes.slopes);
  if (n < figures + 2) {
    return fail(ErrorKind::bad_input, "{} frequencies match, and {} figures need {}", pairs.size(), figures,
                figures + 2);
  }
  Eigen::MatrixXd jacobian(n, figures);
  Eigen::VectorXd off(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Pair& pair = pairs[static_cast<std::size_t>(i)];
    off[i] = pair.off;
    jacobian(i, 0) = 0.5;
    for (Eigen::Index k = 1; k < figures; ++k)
      jacobian(i, k) = slopes.slopes[static_cast<std::size_t>(k - 1)][pair.baked];
  }
  // In units in which each column has a length of 1, so that figures of any unit are told apart alike.
  const Eigen::VectorXd unit = jacobian.colwise().norm();
  if (!(unit.minCoeff() > 0)) return fail(ErrorKind::bad_input, "one of the figures moves no frequency that was heard");
  const Eigen::MatrixXd scaled = jacobian * unit.cwiseInverse().asDiagonal();
  const dense::Spectrum normal = dense::spectrum(scaled.transpose() * scaled);
  constexpr double kTellsApart = 1e-8;
  if (!(normal.values[0] > kTellsApart * normal.values[figures - 1])) {
    return fail(ErrorKind::bad_input, "the frequencies do not tell the figures apart; fit fewer of them");
  }
  const Eigen::MatrixXd inverse =
      normal.vectors * normal.values.cwiseInverse().asDiagonal() * normal.vectors.transpose();
  const Eigen::VectorXd changes = unit.cwiseInverse().asDiagonal() * (inverse * (scaled.transpose() * off));
  const double spread = std::sqrt((off - jacobian * changes).squaredNorm() / static_cast<double>(n - figures));
  Determined found{.spread_cents = kCentsPerNeper * spread, .matches = pairs.size()};
  for (Eigen::Index a = 0; a < figures; ++a) {
    found.changes.push_back(changes[a]);
    found.errors.push_back(spread * std::sqrt(inverse(a, a)) / unit[a]);
    for (Eigen::Index b = 0; b < figures; ++b)
      found.correlations.push_back(inverse(a, b) / std::sqrt(inverse(a, a) * inverse(b, b)));
  }
  return found;
}

}  // namespace ringdown::fit
