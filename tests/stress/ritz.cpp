#include "tests/stress/ritz.h"

#include "engine/dense/blas_threads.h"
#include "engine/dense/decompositions.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace ringdown::test {
namespace {

using Powers = std::array<int, 3>;

struct Lame {
  double lambda, mu;
};

Lame lame(const fem::Elastic& elastic) {
  const double e = elastic.youngs_modulus_pa, nu = elastic.poisson_ratio;
  return {e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 + 2 * nu)};
}

std::vector<double> to_hertz(std::vector<double> lambda, std::size_t count) {
  std::sort(lambda.begin(), lambda.end());
  std::vector<double> hertz;
  for (std::size_t m = 6; m < lambda.size() && hertz.size() < count; ++m) {
    hertz.push_back(std::sqrt(lambda[m]) / (2 * std::numbers::pi));
  }
  return hertz;
}

// Of orthonormal Legendre polynomials on an interval: p_n' = sum over k of rows(n, k) p_k.
Eigen::MatrixXd legendre_derivative(int degree, double length) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(degree + 1, degree + 1);
  for (int n = 0; n <= degree; ++n) {
    for (int k = n - 1; k >= 0; k -= 2) rows(n, k) = 2 / length * std::sqrt((2 * n + 1.0) * (2 * k + 1.0));
  }
  return rows;
}

struct BoxFunction {
  int axis;  // along which it moves
  Powers degree;
};

class Box {
 public:
  Box(const Eigen::Vector3d& size, const fem::Elastic& elastic, const Eigen::Vector3i& degree)
      : lame_(lame(elastic)), density_(elastic.density_kg_m3) {
    for (int a = 0; a < 3; ++a) {
      first_[a] = legendre_derivative(degree[a], size[a]);
      second_[a] = first_[a] * first_[a].transpose();
    }
  }

  // Mirror symmetry parts the functions into eight families that do not mix.
  [[nodiscard]] Eigen::VectorXd eigenvalues(const std::vector<BoxFunction>& family) const {
    const auto size = static_cast<Eigen::Index>(family.size());
    Eigen::MatrixXd stiffness(size, size);
    for (Eigen::Index b = 0; b < size; ++b) {
      for (Eigen::Index a = b; a < size; ++a) stiffness(a, b) = energy(family[a], family[b]);
    }
    return dense::eigenvalues(stiffness) / density_;
  }

 private:
  [[nodiscard]] double energy(const BoxFunction& u, const BoxFunction& v) const {
    double sum = lame_.lambda * slopes(u.degree, u.axis, v.degree, v.axis) +
                 lame_.mu * slopes(u.degree, v.axis, v.degree, u.axis);
    for (int k = 0; k < 3 && u.axis == v.axis; ++k) sum += lame_.mu * slopes(u.degree, k, v.degree, k);
    return sum;
  }

  // The integral of du/dx_i dv/dx_j.
  [[nodiscard]] double slopes(const Powers& u, int i, const Powers& v, int j) const {
    double product = 1;
    for (int a = 0; a < 3; ++a) {
      if (a == i && a == j) {
        product *= second_[a](u[a], v[a]);
      } else if (a == i) {
        product *= first_[a](u[a], v[a]);
      } else if (a == j) {
        product *= first_[a](v[a], u[a]);
      } else if (u[a] != v[a]) {
        return 0;
      }
    }
    return product;
  }

  const Lame lame_;
  const double density_;
  std::array<Eigen::MatrixXd, 3> first_, second_;
};

// x^a y^b z^c over the tetrahedron of barycentric coordinates, divided by six times its volume (Stroud 1971, section
// 7.6).
double integral(const Powers& powers) {
  double product = 1;
  for (const int power : powers) product *= std::tgamma(power + 1);
  return product / std::tgamma(powers[0] + powers[1] + powers[2] + 4);
}

// The integral of d u / d l_i  d v / d l_j.
double slopes(const Powers& u, int i, const Powers& v, int j) {
  if (u[i] == 0 || v[j] == 0) return 0;
  Powers powers = {u[0] + v[0], u[1] + v[1], u[2] + v[2]};
  --powers[i];
  --powers[j];
  return u[i] * v[j] * integral(powers);
}

}  // namespace

std::vector<double> box_frequencies(const Eigen::Vector3d& size_m, const fem::Elastic& elastic,
                                    const Eigen::Vector3i& degree, int total, std::size_t count) {
  const dense::BlasThreads one(1);
  const Box box(size_m, elastic, degree);
  std::array<std::vector<BoxFunction>, 8> families;
  for (int axis = 0; axis < 3; ++axis) {
    for (int x = 0; x <= degree[0]; ++x) {
      for (int y = 0; y <= degree[1]; ++y) {
        for (int z = 0; z <= degree[2] && x + y + z <= total; ++z) {
          const int parity = (x % 2) + 2 * (y % 2) + 4 * (z % 2);
          families[parity ^ (1 << axis)].push_back({axis, {x, y, z}});
        }
      }
    }
  }
  std::vector<double> lambda;
  for (const auto& family : families) {
    const Eigen::VectorXd part = box.eigenvalues(family);
    lambda.insert(lambda.end(), part.begin(), part.end());
  }
  return to_hertz(lambda, count);
}

std::vector<double> box_frequencies(const Eigen::Vector3d& size_m, const fem::Elastic& elastic, std::size_t count) {
  return box_frequencies(size_m, elastic, {17, 17, 17}, 17, count);
}

std::vector<double> tetrahedron_frequencies(const Eigen::Matrix<double, 4, 3>& corners, const fem::Elastic& elastic,
                                            int degree, std::size_t count) {
  const Eigen::Matrix3d edges = corners.bottomRows<3>().rowwise() - corners.row(0);
  const double six_volumes = std::abs(edges.determinant());
  const Eigen::Matrix3d gradient = edges.inverse();  // column i: that of l_i
  const auto [lambda, mu] = lame(elastic);
  std::vector<Powers> functions;
  for (int a = 0; a <= degree; ++a) {
    for (int b = 0; a + b <= degree; ++b) {
      for (int c = 0; a + b + c <= degree; ++c) functions.push_back({a, b, c});
    }
  }
  const auto count3 = 3 * static_cast<Eigen::Index>(functions.size());
  Eigen::MatrixXd stiffness(count3, count3), mass = Eigen::MatrixXd::Zero(count3, count3);
  for (std::size_t u = 0; u < functions.size(); ++u) {
    for (std::size_t v = 0; v < functions.size(); ++v) {
      Eigen::Matrix3d inner;  // of d u / d l_i and d v / d l_j
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) inner(i, j) = six_volumes * slopes(functions[u], i, functions[v], j);
      }
      const Eigen::Matrix3d s = gradient * inner * gradient.transpose();  // of d u / d x_i and d v / d x_j
      const Powers product = {functions[u][0] + functions[v][0], functions[u][1] + functions[v][1],
                              functions[u][2] + functions[v][2]};
      const auto row = 3 * static_cast<Eigen::Index>(u), column = 3 * static_cast<Eigen::Index>(v);
      stiffness.block<3, 3>(row, column) =
          lambda * s + mu * s.transpose() + mu * s.trace() * Eigen::Matrix3d::Identity();
      mass.block<3, 3>(row, column) =
          elastic.density_kg_m3 * six_volumes * integral(product) * Eigen::Matrix3d::Identity();
    }
  }
  const Eigen::VectorXd solved = dense::generalized_spectrum(stiffness, mass)->values;
  return to_hertz({solved.begin(), solved.end()}, count);
}

}  // namespace ringdown::test
