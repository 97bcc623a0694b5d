#include "engine/liquid/water_modes.h"

#include "engine/dense/decompositions.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace ringdown::liquid {
namespace {

constexpr int kDegree = 9;              // of the polynomials, in all three coordinates together
constexpr double kIndependent = 1e-10;  // of the largest eigenvalue of the polynomials' products
constexpr int kColumns = 256;           // that are summed up at once

// Points and weights of Gauss and Legendre on [0, 1], by Newton's method.
std::vector<std::pair<double, double>> gauss(int count) {
  std::vector<std::pair<double, double>> rule;
  for (int i = 0; i < count; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5)), slope = 1;
    for (int step = 0; step < 30; ++step) {
      double p = 1, before = 0;
      for (int n = 1; n <= count; ++n) before = std::exchange(p, ((2 * n - 1) * x * p - (n - 1) * before) / n);
      slope = count * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    rule.emplace_back((1 - x) / 2, 1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

}  // namespace

WaterModes::Terms WaterModes::terms_at(const mesh::Points& places) const {
  const int degree = open_ ? kDegree - 1 : kDegree;
  const Eigen::Index count = places.rows();
  std::array<std::vector<Eigen::ArrayXd>, 3> t, dt;  // by axis and degree
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::ArrayXd x = 2 * (places.col(axis).array() - low_[axis]) / size_[axis] - 1;
    t[axis] = {Eigen::ArrayXd::Ones(count), x};
    dt[axis] = {Eigen::ArrayXd::Zero(count), Eigen::ArrayXd::Ones(count)};
    for (int n = 2; n <= degree; ++n) {
      t[axis].emplace_back(2 * x * t[axis][n - 1] - t[axis][n - 2]);
      dt[axis].emplace_back(2 * t[axis][n - 1] + 2 * x * dt[axis][n - 1] - dt[axis][n - 2]);
    }
    for (Eigen::ArrayXd& slope : dt[axis]) slope *= 2 / size_[axis];
  }
  if (open_) {  // times the depth
    const Eigen::ArrayXd depth = places.col(0).array() / size_[0];
    for (int n = 0; n <= degree; ++n) {
      dt[0][n] = depth * dt[0][n] + t[0][n] / size_[0];
      t[0][n] *= depth;
    }
  }
  const int terms = (degree + 1) * (degree + 2) * (degree + 3) / 6;
  Terms found;
  found.values.resize(count, terms);
  for (Eigen::MatrixXd& slope : found.slopes) slope.resize(count, terms);
  int column = 0;
  for (int a = 0; a <= degree; ++a) {
    for (int b = 0; a + b <= degree; ++b) {
      const Eigen::ArrayXd ab = t[0][a] * t[1][b], da = dt[0][a] * t[1][b], db = t[0][a] * dt[1][b];
      for (int c = 0; a + b + c <= degree; ++c, ++column) {
        found.values.col(column) = ab * t[2][c];
        found.slopes[0].col(column) = da * t[2][c];
        found.slopes[1].col(column) = db * t[2][c];
        found.slopes[2].col(column) = ab * dt[2][c];
      }
    }
  }
  return found;
}

WaterModes::WaterModes(const Wetted& liquid, const radiate::Panels& panels) : open_(liquid.open) {
  low_ = panels.nodes.colwise().minCoeff();
  if (open_) low_[0] = 0;
  size_ = panels.nodes.colwise().maxCoeff() - low_;
  const auto rule = gauss(kDegree + 1);
  std::vector<int> order;
  for (const bool down : {true, false}) {  // columns that count positive, then those below overhangs
    for (int t = 0; t < panels.triangle_count(); ++t) {
      if ((panels.normals[t][0] > 0) == down && panels.normals[t][0] != 0) order.push_back(t);
    }
  }
  Eigen::MatrixXd steep, heavy;
  for (std::size_t first = 0; first < order.size();) {
    const bool down = panels.normals[order[first]][0] > 0;
    std::size_t last = first;
    while (last < order.size() && last < first + kColumns && (panels.normals[order[last]][0] > 0) == down) ++last;
    const auto columns = static_cast<Eigen::Index>(last - first), points = static_cast<Eigen::Index>(rule.size());
    mesh::Points places(columns * points, 3);
    Eigen::VectorXd roots(columns * points);  // of the weights
    for (Eigen::Index c = 0; c < columns; ++c) {
      const int t = order[first + static_cast<std::size_t>(c)];
      const Eigen::Vector3d& foot = panels.centers[t];
      const double length = foot[0] - low_[0], weight = panels.areas[t] * std::abs(panels.normals[t][0]) * length;
      for (Eigen::Index p = 0; p < points; ++p) {
        places.row(c * points + p) << low_[0] + rule[p].first * length, foot[1], foot[2];
        roots[c * points + p] = std::sqrt(std::max(weight, 0.0) * rule[p].second);
      }
    }
    const Terms terms = terms_at(places);
    if (heavy.size() == 0) steep = heavy = Eigen::MatrixXd::Zero(terms.values.cols(), terms.values.cols());
    const double sign = down ? 1 : -1;
    const auto add = [&](const Eigen::MatrixXd& values, Eigen::MatrixXd& sum) {
      const Eigen::MatrixXd weighed = (roots.asDiagonal() * values).transpose();
      sum.selfadjointView<Eigen::Lower>().rankUpdate(weighed, sign);
    };
    add(terms.values, heavy);
    for (const Eigen::MatrixXd& slope : terms.slopes) add(slope, steep);
    first = last;
  }
  const dense::Spectrum products = dense::spectrum(heavy);
  const double min = kIndependent * products.values.maxCoeff();
  const Eigen::Index kept = (products.values.array() > min).count();  // values ascend
  const Eigen::MatrixXd basis =
      products.vectors.rightCols(kept) * products.values.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd whole = steep.selfadjointView<Eigen::Lower>();
  const dense::Spectrum modes = dense::spectrum(basis.transpose() * whole * basis);
  mixing_ = basis * modes.vectors;
  wavenumbers_ = modes.values.cwiseMax(0.0).cwiseSqrt();
}

Eigen::MatrixXd WaterModes::values(const mesh::Points& places) const { return terms_at(places).values * mixing_; }

std::array<Eigen::MatrixXd, 3> WaterModes::slopes(const mesh::Points& places) const {
  std::array<Eigen::MatrixXd, 3> slopes = terms_at(places).slopes;
  for (Eigen::MatrixXd& slope : slopes) slope = slope * mixing_;
  return slopes;
}

}  // namespace ringdown::liquid
