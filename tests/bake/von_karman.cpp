// Deflections w are products of Legendre polynomials on the square, for the energy D/2 [(lap w)^2 - 2 (1 - nu) det
// grad grad w]; the membrane's strain 1/2 w_i w_j is condensed by least squares over in-plane displacements, products
// of Legendre polynomials too. Chu & Herrmann's and Touze, Thomas & Chaigne's coefficients follow from the same
// equations.
#include "tests/bake/von_karman.h"

#include "engine/dense/decompositions.h"

#include <Eigen/Cholesky>

#include <cmath>
#include <vector>

namespace ringdown::test {
namespace {

// Gauss's rule on [-1, 1] from the eigenvalues of Jacobi's matrix (Golub & Welsch).
void gauss(int n, Eigen::VectorXd& x, Eigen::VectorXd& w) {
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(n, n);
  for (int i = 1; i < n; ++i) jacobi(i, i - 1) = jacobi(i - 1, i) = i / std::sqrt(4.0 * i * i - 1);
  const dense::Spectrum solved = dense::spectrum(jacobi);
  x = solved.values;
  w = 2 * solved.vectors.row(0).transpose().cwiseAbs2();
}

// Orthonormal Legendre polynomials up to degree p and their two derivatives at the points: each points x (p + 1).
struct Legendre {
  Eigen::MatrixXd value, first, second;
  Legendre(int p, const Eigen::VectorXd& x) {
    value = first = second = Eigen::MatrixXd::Zero(x.size(), p + 1);
    for (Eigen::Index q = 0; q < x.size(); ++q) {
      value(q, 0) = 1;
      if (p > 0) value(q, 1) = x[q], first(q, 1) = 1;
      for (int n = 1; n < p; ++n) {
        value(q, n + 1) = ((2 * n + 1) * x[q] * value(q, n) - n * value(q, n - 1)) / (n + 1);
        first(q, n + 1) = first(q, n - 1) + (2 * n + 1) * value(q, n);
        second(q, n + 1) = second(q, n - 1) + (2 * n + 1) * first(q, n);
      }
    }
    for (int n = 0; n <= p; ++n) {
      for (Eigen::MatrixXd* m : {&value, &first, &second}) m->col(n) *= std::sqrt(n + 0.5);
    }
  }
};

// All products a_i(x) b_j(y) at the points (x, y) of a tensor grid, or at a list of points.
Eigen::MatrixXd products(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, int max_total) {
  std::vector<Eigen::VectorXd> columns;
  for (Eigen::Index i = 0; i < a.cols(); ++i) {
    for (Eigen::Index j = 0; j < b.cols(); ++j) {
      if (i + j <= max_total) columns.emplace_back(a.col(i).cwiseProduct(b.col(j)));
    }
  }
  Eigen::MatrixXd all(a.rows(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) all.col(static_cast<Eigen::Index>(c)) = columns[c];
  return all;
}

// A free plate whose points, at (scale x, scale y), and weights [m^2] are given.
PlateTerms plate(const Eigen::VectorXd& x, const Eigen::VectorXd& y, const Eigen::VectorXd& weights, double scale,
                 double thickness, const fem::Elastic& elastic, int modes, int degree, int membrane_degree,
                 bool total) {
  const double nu = elastic.poisson_ratio, h = thickness, e = elastic.youngs_modulus_pa;
  const double bending = e * h * h * h / (12 * (1 - nu * nu)), stretch = e * h / (1 - nu * nu);
  const int all = 2 * (degree + membrane_degree);
  const Legendre a(degree, x), b(degree, y);
  const int max = total ? degree : all;
  const Eigen::MatrixXd w = products(a.value, b.value, max), wx = products(a.first, b.value, max) / scale,
                        wy = products(a.value, b.first, max) / scale,
                        wxx = products(a.second, b.value, max) / (scale * scale),
                        wyy = products(a.value, b.second, max) / (scale * scale),
                        wxy = products(a.first, b.first, max) / (scale * scale);
  const auto form = [&](const Eigen::MatrixXd& p, const Eigen::MatrixXd& q) {
    return Eigen::MatrixXd(p.transpose() * weights.asDiagonal() * q);
  };
  const Eigen::MatrixXd stiffness = bending * (form(wxx, wxx) + form(wyy, wyy) +
                                               nu * (form(wxx, wyy) + form(wyy, wxx)) + 2 * (1 - nu) * form(wxy, wxy));
  const Eigen::MatrixXd mass = elastic.density_kg_m3 * h * form(w, w);
  const dense::Spectrum solved = dense::generalized_spectrum(stiffness, mass).value();
  PlateTerms result{solved.values.segment(3, modes), {}};
  const Eigen::MatrixXd shapes = solved.vectors.middleCols(3, modes);
  const Eigen::MatrixXd sx = wx * shapes, sy = wy * shapes;

  // Strains (e11, e22, 2 e12) as vectors whose inner product is the energy: the rows of a Cholesky factor.
  Eigen::Matrix3d law;
  law << 1, nu, 0, nu, 1, 0, 0, 0, (1 - nu) / 2;
  const Eigen::Matrix3d root = (stretch * law).llt().matrixU();
  const Eigen::VectorXd side = weights.cwiseSqrt();
  const Eigen::Index points = x.size();
  const auto field = [&](const Eigen::MatrixXd& e11, const Eigen::MatrixXd& e22, const Eigen::MatrixXd& e12) {
    Eigen::MatrixXd rows(3 * points, e11.cols());
    for (int r = 0; r < 3; ++r) {
      rows.middleRows(r * points, points) =
          side.asDiagonal() * (root(r, 0) * e11 + root(r, 1) * e22 + root(r, 2) * e12);
    }
    return rows;
  };
  const Legendre c(membrane_degree, x), d(membrane_degree, y);
  const int max_in_plane = total ? membrane_degree : all;
  const Eigen::MatrixXd ux = products(c.first, d.value, max_in_plane) / scale,
                        uy = products(c.value, d.first, max_in_plane) / scale;
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(ux.rows(), ux.cols());
  Eigen::MatrixXd in_plane(3 * points, 2 * ux.cols());
  in_plane << field(ux, zero, uy), field(zero, uy, ux);

  Eigen::MatrixXd pairs(3 * points, modes * (modes + 1) / 2);
  for (int i = 0, at = 0; i < modes; ++i) {
    for (int j = 0; j <= i; ++j, ++at) {
      pairs.col(at) = field(0.5 * sx.col(i).cwiseProduct(sx.col(j)), 0.5 * sy.col(i).cwiseProduct(sy.col(j)),
                            0.5 * (sx.col(i).cwiseProduct(sy.col(j)) + sy.col(i).cwiseProduct(sx.col(j))));
    }
  }
  const Eigen::MatrixXd normal = in_plane.transpose() * in_plane;  // three rigid motions: regularised
  const double small = 1e-12 * normal.diagonal().maxCoeff();
  const Eigen::LDLT<Eigen::MatrixXd> factored(normal + small * Eigen::MatrixXd::Identity(normal.rows(), normal.cols()));
  result.pairs = pairs - in_plane * factored.solve(in_plane.transpose() * pairs);
  return result;
}

}  // namespace

Eigen::VectorXd PlateTerms::own_hardening(double family) const {
  Eigen::VectorXd own(lambda.size());
  for (Eigen::Index first = 0, end = 0; first < lambda.size(); first = end) {
    for (end = first + 1; end < lambda.size() && std::sqrt(lambda[end] / lambda[first]) - 1 < family;) ++end;
    Eigen::VectorXd trace = Eigen::VectorXd::Zero(pairs.rows());
    double sum = 0;
    for (Eigen::Index i = first; i < end; ++i) {
      trace += field(i, i);
      for (Eigen::Index j = first; j < end; ++j) sum += 2 * field(i, j).squaredNorm();
    }
    const auto size = static_cast<double>(end - first);
    const double mean = lambda.segment(first, end - first).mean();
    own.segment(first, end - first).setConstant((sum + trace.squaredNorm()) / (size * (size + 2) * mean * mean));
  }
  return own;
}

PlateTerms von_karman_square(double side, double thickness, const fem::Elastic& elastic, int modes, int degree,
                             int membrane_degree) {
  const int n = membrane_degree + 10;
  Eigen::VectorXd at, weight, x(n * n), y(n * n), weights(n * n);
  gauss(n, at, weight);
  for (int i = 0; i < n * n; ++i) {
    x[i] = at[i / n], y[i] = at[i % n];
    weights[i] = weight[i / n] * weight[i % n] * side * side / 4;
  }
  return plate(x, y, weights, side / 2, thickness, elastic, modes, degree, membrane_degree, false);
}

PlateTerms von_karman_disc(double radius, double thickness, const fem::Elastic& elastic, int modes, int degree,
                           int membrane_degree) {
  const int n = membrane_degree + 4, around = 3 * membrane_degree + 8;
  Eigen::VectorXd at, weight, x(n * around), y(n * around), weights(n * around);
  gauss(n, at, weight);
  for (int i = 0; i < n * around; ++i) {
    const double r = 0.5 * (at[i / around] + 1), angle = 2 * M_PI * (i % around) / around;
    x[i] = r * std::cos(angle), y[i] = r * std::sin(angle);
    weights[i] = 0.5 * weight[i / around] * r * 2 * M_PI / around * radius * radius;
  }
  return plate(x, y, weights, radius, thickness, elastic, modes, degree, membrane_degree, true);
}

}  // namespace ringdown::test
