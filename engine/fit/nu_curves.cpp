#include "engine/fit/nu_curves.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

// Following modes from bank to bank
//
// Frequencies of different modes cross where Poisson's ratio changes, so the n-th mode of one bank need not be the n-th
// mode of another. In a block with edges of 1 : 1.1 : 1.2, eleven of the first twenty modes change places between the
// ratios 0.25 and 0.45, and frequencies that are interpolated by rank are 16 cents off on average. Shapes hardly
// change: over these 0.2 the shapes of a mode agree to 94 % or more. Therefore two modes are taken to be one if each
// agrees best with the other and the square of the cosine of their shapes, over all points of the surface, is above one
// half. Modes of equal frequency may be any mixtures of each other; they, and modes of banks with different points, are
// paired by rank.
//
// Between the banks
//
// At constant E, a thin plate or wall that bends has f^2 ~ 1 / (1 - nu^2), and a motion whose shape does not change has
// f^2 = a / (1 + nu) + b nu / ((1 + nu) (1 - 2 nu)), with a from its shear and b from its compression. Multiplied by
// (1 - nu^2) (1 - 2 nu), both are polynomials of at most second order, so three banks give such modes exactly over all
// ratios. Parabolas of f itself, between the ratios 0.05, 0.25 and 0.45, were up to 230 cents off for compression.
namespace ringdown::fit {
namespace {

constexpr float kSame = 0.5F;
constexpr std::size_t kMinPoints = 4;  // at fewer common points, different modes have alike shapes
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

double smooth(double nu) { return (1 - nu * nu) * (1 - 2 * nu); }

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

// The numbers of the points that both lists have. Banks of one mesh whose elements have different orders share the
// elements' corners.
Pairs common_points(const std::vector<modal::Vec3f>& a, const std::vector<modal::Vec3f>& b) {
  std::map<modal::Vec3f, std::size_t> number;
  for (std::size_t p = 0; p < a.size(); ++p) number.emplace(a[p], p);
  Pairs pairs;
  for (std::size_t p = 0; p < b.size(); ++p) {
    if (const auto found = number.find(b[p]); found != number.end()) pairs.emplace_back(found->second, p);
  }
  return pairs;
}

// The shapes of `count` modes at some of the points, as columns of length 1.
template <class Member>
Eigen::MatrixXf shapes_at(const Pairs& points, Member member, const std::vector<modal::Vec3f>& shapes,
                          std::size_t count) {
  const std::size_t all = shapes.size() / count;
  Eigen::MatrixXf columns(static_cast<Eigen::Index>(3 * points.size()), static_cast<Eigen::Index>(count));
  for (std::size_t m = 0; m < count; ++m) {
    float* to = columns.col(static_cast<Eigen::Index>(m)).data();
    for (const auto& pair : points) to = std::ranges::copy(shapes[m * all + pair.*member], to).out;
  }
  columns.colwise().normalize();
  return columns;
}

}  // namespace

NuCurves::Modes::Modes(const modal::Bank& bank) : positions(bank.positions) {
  std::vector<std::size_t> order(bank.mode_count());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t m) { return bank.frequency_hz[m]; });
  for (const std::size_t m : order) frequency_hz.push_back(bank.frequency_hz[m]);
  if (bank.shapes.empty()) return;
  for (const std::size_t m : order) {
    for (std::size_t p = 0; p < bank.point_count(); ++p) shapes.push_back(bank.shape(m, p));
  }
}

// Returns for each mode of `of` the number of its partner in `among`, or kNone.
std::vector<std::size_t> NuCurves::partners(const Modes& of, const Modes& among) {
  const std::size_t count = of.frequency_hz.size(), others = among.frequency_hz.size();
  std::vector<std::size_t> partner(count, kNone);
  std::vector<bool> taken(others);
  const Pairs points =
      of.shapes.empty() || among.shapes.empty() ? Pairs() : common_points(of.positions, among.positions);
  if (points.size() >= kMinPoints) {
    const Eigen::MatrixXf agreement = (shapes_at(points, &Pairs::value_type::first, of.shapes, count).transpose() *
                                       shapes_at(points, &Pairs::value_type::second, among.shapes, others))
                                          .cwiseAbs2();
    for (Eigen::Index m = 0; m < agreement.rows(); ++m) {
      Eigen::Index best = 0, back = 0;
      if (!(agreement.row(m).maxCoeff(&best) > kSame)) continue;
      agreement.col(best).maxCoeff(&back);
      if (back != m) continue;
      partner[static_cast<std::size_t>(m)] = static_cast<std::size_t>(best);
      taken[static_cast<std::size_t>(best)] = true;
    }
  }
  std::size_t next = 0;
  for (std::size_t& number : partner) {
    if (number != kNone) continue;
    while (next < others && taken[next]) ++next;
    if (next < others) number = next++;
  }
  return partner;
}

NuCurves::NuCurves(std::span<const NuBank> banks)
    : lowest_(banks.front().poisson_ratio),
      highest_(banks.back().poisson_ratio),
      frequencies_(banks.size()),
      middle_(*banks[banks.size() / 2].bank) {
  for (const NuBank& bank : banks) nu_.push_back(bank.poisson_ratio);
  const std::size_t middle = banks.size() / 2, count = middle_.frequency_hz.size();
  std::vector<bool> followed(count, true);
  // Takes the frequencies of bank `to`, whose modes are followed from its neighbour `from`. `number` has the number of
  // each curve's mode in `from`, and then in `to`.
  const auto follow = [&](std::size_t from, std::size_t to, std::vector<std::size_t>& number) {
    const Modes modes(*banks[to].bank);
    const std::vector<std::size_t> partner = partners(Modes(*banks[from].bank), modes);
    for (std::size_t curve = 0; curve < count; ++curve) {
      number[curve] = number[curve] == kNone ? kNone : partner[number[curve]];
      if (number[curve] == kNone) followed[curve] = false;
      frequencies_[to].push_back(number[curve] == kNone ? 0 : modes.frequency_hz[number[curve]]);
    }
  };
  std::vector<std::size_t> own(count);
  std::iota(own.begin(), own.end(), 0);
  frequencies_[middle] = middle_.frequency_hz;
  std::vector<std::size_t> number = own;
  for (std::size_t i = middle; i > 0; --i) follow(i, i - 1, number);
  number = own;
  for (std::size_t i = middle; i + 1 < banks.size(); ++i) follow(i, i + 1, number);
  std::erase_if(own, [&](std::size_t curve) { return !followed[curve]; });
  keep(own);
}

NuCurves NuCurves::around(double nu, double aside) const {
  NuCurves result = *this;
  result.lowest_ = std::max(lowest_, nu - aside);
  result.highest_ = std::min(highest_, nu + aside);
  return result;
}

void NuCurves::keep(const std::vector<std::size_t>& curves) {
  const auto take = [&](std::vector<double>& list) {
    std::vector<double> kept;
    for (const std::size_t curve : curves) kept.push_back(list[curve]);
    list = std::move(kept);
  };
  for (std::vector<double>& list : frequencies_) take(list);
  std::vector<modal::Vec3f> shapes;
  const std::size_t size = middle_.shapes.size() / std::max<std::size_t>(middle_.frequency_hz.size(), 1);
  for (const std::size_t curve : curves) {
    const auto first = middle_.shapes.begin() + static_cast<std::ptrdiff_t>(curve * size);
    shapes.insert(shapes.end(), first, first + static_cast<std::ptrdiff_t>(size));
  }
  middle_.shapes = std::move(shapes);
  take(middle_.frequency_hz);
}

// The frequencies at a ratio, in the order of the curves: by the polynomial through `smooth(nu) f^2` of the banks
// (Lagrange).
std::vector<double> NuCurves::in_order(double nu) const {
  constexpr double kMin = 1e-300;  // far outside of the banks' ratios a polynomial may fall below zero
  std::vector<double> result(frequencies_[0].size());
  for (std::size_t i = 0; i < nu_.size(); ++i) {
    double weight = smooth(nu_[i]);
    for (std::size_t j = 0; j < nu_.size(); ++j) weight *= j == i ? 1 : (nu - nu_[j]) / (nu_[i] - nu_[j]);
    for (std::size_t k = 0; k < result.size(); ++k) result[k] += weight * frequencies_[i][k] * frequencies_[i][k];
  }
  for (double& value : result) value = std::sqrt(std::max(value, kMin) / smooth(nu));
  return result;
}

std::vector<double> NuCurves::at(double nu) const {
  std::vector<double> result = in_order(nu);
  std::ranges::sort(result);
  return result;
}

NuCurves NuCurves::through(const modal::Bank& exact, double nu) const {
  NuCurves result = *this;
  const Modes modes(exact);
  const std::vector<std::size_t> partner = partners(middle_, modes);
  const std::vector<double> here = in_order(nu);
  std::vector<std::size_t> whole;
  for (std::size_t k = 0; k < here.size(); ++k) {
    if (partner[k] == kNone) continue;
    whole.push_back(k);
    for (std::vector<double>& list : result.frequencies_) list[k] *= modes.frequency_hz[partner[k]] / here[k];
  }
  result.keep(whole);
  return result;
}

Slopes NuCurves::slopes(double nu) const {
  constexpr double kStep = 1e-4;
  const std::vector<double> here = in_order(nu), below = in_order(nu - kStep), above = in_order(nu + kStep);
  std::vector<std::size_t> order(here.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t k) { return here[k]; });
  Slopes slopes{{}, {{}}};
  for (const std::size_t k : order) {
    slopes.frequency_hz.push_back(here[k]);
    slopes.slopes[0].push_back(std::log(above[k] / below[k]) / (2 * kStep));
  }
  return slopes;
}

}  // namespace ringdown::fit
