#include "engine/solve/mode_set.h"

#include "engine/dense/decompositions.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::solve {
namespace {

constexpr double kZone = 1e-4;    // relative; half the width of the range that join_at() treats
constexpr double kFamily = 1e-6;  // closer than this, eigenvalues may be one multiple eigenvalue
constexpr double kCopies = 1e-2;  // a shape is a copy if its squared length outside the others' span is smaller

// X^T A X for A = M or K.
using Product = void (OrderedSystem::*)(const Block&, Block&) const;
Eigen::MatrixXd project(const OrderedSystem& system, Product product, const Eigen::MatrixXd& x) {
  Eigen::MatrixXd result(x.cols(), x.cols());
  for (Eigen::Index first = 0; first < x.cols(); first += kWidth) {
    const Eigen::Index width = std::min<Eigen::Index>(kWidth, x.cols() - first);
    Block block = Block::Zero(kWidth, x.rows()), image;
    block.topRows(width) = x.middleCols(first, width).transpose();
    (system.*product)(block, image);
    result.middleCols(first, width) = x.transpose() * image.topRows(width).transpose();
  }
  return 0.5 * (result + result.transpose());
}

}  // namespace

void ModeSet::add(const std::vector<double>& lambda, Eigen::MatrixXd shapes) {
  const auto kept = std::make_shared<const Eigen::MatrixXd>(std::move(shapes));
  for (std::size_t i = 0; i < lambda.size(); ++i) {
    modes_.push_back({lambda[i], kept, static_cast<Eigen::Index>(i)});
  }
  std::stable_sort(modes_.begin(), modes_.end(), [](const Mode& a, const Mode& b) { return a.lambda < b.lambda; });
}

std::vector<ModeSet::Mode>::iterator ModeSet::at_least(double lambda) {
  return std::partition_point(modes_.begin(), modes_.end(), [lambda](const Mode& m) { return m.lambda < lambda; });
}

std::vector<ModeSet::Mode>::const_iterator ModeSet::at_least(double lambda) const {
  return std::partition_point(modes_.begin(), modes_.end(), [lambda](const Mode& m) { return m.lambda < lambda; });
}

int ModeSet::count(double low, double high) const {
  return static_cast<int>(std::max<std::ptrdiff_t>(0, at_least(high) - at_least(low)));
}

Eigen::MatrixXd ModeSet::shapes(double low, double high) const {
  Eigen::MatrixXd result(system_.unknowns(), count(low, high));
  auto mode = at_least(low);
  for (Eigen::Index i = 0; i < result.cols(); ++i, ++mode) result.col(i) = mode->shape();
  return result;
}

void ModeSet::join_at(double lambda) {
  auto first = at_least(lambda - kZone * std::abs(lambda)), last = at_least(lambda + kZone * std::abs(lambda));
  const auto close = [](const Mode& a, const Mode& b) { return b.lambda - a.lambda < kFamily * std::abs(b.lambda); };
  while (first != modes_.begin() && first != modes_.end() && close(*(first - 1), *first)) --first;
  while (last != modes_.end() && last != modes_.begin() && close(*(last - 1), *last)) ++last;
  if (last - first < 2) return;

  Eigen::MatrixXd x(system_.unknowns(), last - first);
  for (Eigen::Index i = 0; i < x.cols(); ++i) x.col(i) = (first + i)->shape();
  const dense::Spectrum gram = dense::spectrum(project(system_, &OrderedSystem::times_mass, x));
  const Eigen::Index kept = (gram.values.array() > kCopies).count();
  x = (x * (gram.vectors.rightCols(kept) * gram.values.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal())).eval();
  const dense::Spectrum ritz = dense::spectrum(project(system_, &OrderedSystem::times_stiffness, x));
  const auto joined = std::make_shared<const Eigen::MatrixXd>(x * ritz.vectors);
  for (Eigen::Index i = 0; i < kept; ++i) *(first + i) = {ritz.values[i], joined, i};
  modes_.erase(first + kept, last);
}

}  // namespace ringdown::solve
