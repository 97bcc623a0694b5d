#include "engine/fem/solid.h"

#include "engine/dense/decompositions.h"

#include <cmath>

namespace ringdown::fem {
namespace {

Matrix6 compliance(const EngineeringConstants& constants) {
  const auto& [e, nu, g] = constants;
  Matrix6 s = Matrix6::Zero();
  for (int i = 0; i < 3; ++i) s(i, i) = 1 / e[i];
  s(0, 1) = s(1, 0) = -nu[0] / e[0];
  s(0, 2) = s(2, 0) = -nu[1] / e[0];
  s(1, 2) = s(2, 1) = -nu[2] / e[1];
  s(3, 3) = 1 / g[2];
  s(4, 4) = 1 / g[1];
  s(5, 5) = 1 / g[0];
  return s;
}

bool is_positive(const Matrix6& matrix) {
  constexpr double kSingular = 1e-9;
  // Scaled to a diagonal of 1, so that soft directions do not look like singular ones.
  const Eigen::Array<double, 6, 1> diagonal = matrix.diagonal().array();
  if (!matrix.allFinite() || !(diagonal > 0).all()) return false;
  const Eigen::Matrix<double, 6, 1> scale = diagonal.rsqrt().matrix();
  const Matrix6 scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
  return dense::eigenvalues(scaled)[0] > kSingular;
}

}  // namespace

Result<void> check_solid(const Solid& solid) {
  for (const Law& law : solid.laws()) {
    if (!law.stiffness_pa) {
      if (auto stable = check_elastic(law.elastic); !stable) return stable;
      continue;
    }
    if (!(law.elastic.density_kg_m3 > 0 && law.elastic.density_kg_m3 < 1e6))
      return fail(ErrorKind::bad_input, "the density must be a positive number of kg/m^3");
    if (!is_positive(*law.stiffness_pa))
      return fail(ErrorKind::bad_input, "its stiffnesses are not those of a stable solid");
  }
  return {};
}

Matrix6 isotropic_stiffness(const Elastic& elastic) {
  Matrix6 c = Matrix6::Zero();
  c.topLeftCorner<3, 3>().setConstant(elastic.lambda_pa());
  c.diagonal().head<3>().array() += 2 * elastic.mu_pa();
  c.diagonal().tail<3>().setConstant(elastic.mu_pa());
  return c;
}

Result<Matrix6> orthotropic_stiffness(const EngineeringConstants& constants) {
  const auto& [e, nu, g] = constants;
  if (!(e > 0).all() || !(g > 0).all() || !e.allFinite() || !g.allFinite())
    return fail(ErrorKind::bad_input, "Young's and shear moduli must be positive numbers of pascals");
  const Matrix6 s = compliance(constants);
  if (!is_positive(s)) {
    return fail(ErrorKind::bad_input,
                "no stable solid has these Poisson's ratios together with these moduli: nu_ij must stay below "
                "sqrt(E_i / E_j), and all three within 1 - nu12 nu21 - nu23 nu32 - nu13 nu31 - 2 nu21 nu32 nu13 > 0");
  }
  return Matrix6(dense::inverse(s));
}

// A modulus E (1 + i eta) gives S the imaginary part -eta / E, and C = S^-1 then has C (eta / E) C. Between two axes of
// different loss the geometric mean keeps the loss positive.
Matrix6 lost_stiffness(const EngineeringConstants& constants, const Eigen::Array<double, 6, 1>& eta) {
  const Matrix6 s = compliance(constants), c = dense::inverse(s);
  Matrix6 lost = Matrix6::Zero();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) lost(i, j) = s(i, j) * std::sqrt(eta[i] * eta[j]);
  }
  lost(3, 3) = s(3, 3) * eta[5];
  lost(4, 4) = s(4, 4) * eta[4];
  lost(5, 5) = s(5, 5) * eta[3];
  return c * lost * c;
}

Matrix6 rotated(const Matrix6& stiffness, const Eigen::Matrix3d& axes) {
  constexpr int kFirst[6] = {0, 1, 2, 1, 0, 0}, kSecond[6] = {0, 1, 2, 2, 2, 1};
  Matrix6 bond;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      const int i = kFirst[row], j = kSecond[row], k = kFirst[column], l = kSecond[column];
      bond(row, column) = k == l ? axes(i, k) * axes(j, k) : axes(i, k) * axes(j, l) + axes(i, l) * axes(j, k);
    }
  }
  return bond * stiffness * bond.transpose();
}

GradientToStiffness gradient_to_stiffness(const Matrix6& stiffness) {
  GradientToStiffness blocks;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      for (int l = 0; l < 3; ++l) {
        for (int k = 0; k < 3; ++k) blocks(3 * j + i, 3 * l + k) = stiffness(voigt(i, k), voigt(j, l));
      }
    }
  }
  return blocks;
}

}  // namespace ringdown::fem
