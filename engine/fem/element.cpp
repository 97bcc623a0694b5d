#include "engine/fem/element.h"

#include <Eigen/LU>

#include <vector>

namespace ringdown::fem {
namespace {

using mesh::Gradient10;

// stiffness += weight * (lambda g_a g_b^T + mu g_b g_a^T + mu g_a.g_b I), gradients in rows.
template <int kNodes>
void add_stiffness(Eigen::Matrix<double, 3 * kNodes, 3 * kNodes>& stiffness,
                   const Eigen::Matrix<double, kNodes, 3>& gradient, const Elastic& elastic, double weight) {
  const double lambda = weight * elastic.lambda_pa(), mu = weight * elastic.mu_pa();
  for (int b = 0; b < kNodes; ++b) {
    for (int a = 0; a < kNodes; ++a) {
      const double diagonal = mu * gradient.row(a).dot(gradient.row(b));
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
          stiffness(3 * a + i, 3 * b + j) += lambda * gradient(a, i) * gradient(b, j) +
                                             mu * gradient(a, j) * gradient(b, i) + (i == j ? diagonal : 0.0);
        }
      }
    }
  }
}

struct Sample {
  double weight;
  mesh::Shape10 shape;
  Gradient10 reference_gradient;
};

std::vector<Sample> sampled(int degree) {
  std::vector<Sample> samples;
  for (const mesh::QuadraturePoint& point : mesh::tet_quadrature(degree)) {
    samples.push_back(
        {point.weight, mesh::shape10(point.barycentric), mesh::reference_gradient10(point.barycentric)});
  }
  return samples;
}

Mass10 straight_mass_per_volume() {
  Mass10 mass = Mass10::Zero();
  for (const Sample& sample : sampled(4)) mass += sample.weight * sample.shape * sample.shape.transpose();
  return mass;
}

double volume4(const mesh::Corners& corners) {
  return mesh::jacobian4(corners).determinant() / 6;
}

} // namespace

Result<void> check_elastic(const Elastic& elastic) {
  if (!(elastic.youngs_modulus_pa > 0 && elastic.youngs_modulus_pa < 1e15)) {
    return fail("Young's modulus must be a positive number of pascals");
  }
  if (!(elastic.poisson_ratio > -1 && elastic.poisson_ratio < 0.5)) {
    return fail("Poisson's ratio must lie between -1 and 0.5, both excluded");
  }
  if (!(elastic.density_kg_m3 > 0 && elastic.density_kg_m3 < 1e6)) {
    return fail("the density must be a positive number of kg/m^3");
  }
  return {};
}

Stiffness4 stiffness4(const mesh::Corners& corners, const Elastic& elastic) {
  const Eigen::Matrix3d inverse = mesh::jacobian4(corners).inverse();
  mesh::Corners gradient;
  gradient.bottomRows<3>() = inverse.transpose();
  gradient.row(0) = -gradient.bottomRows<3>().colwise().sum();
  Stiffness4 stiffness = Stiffness4::Zero();
  add_stiffness<4>(stiffness, gradient, elastic, volume4(corners));
  return stiffness;
}

Mass4 consistent_mass4(const mesh::Corners& corners, double density_kg_m3) {
  return density_kg_m3 * volume4(corners) / 20 * (Mass4::Ones() + Mass4::Identity());
}

Mass4 lumped_mass4(const mesh::Corners& corners, double density_kg_m3) {
  return density_kg_m3 * volume4(corners) / 4 * Mass4::Identity();
}

Stiffness10 stiffness10(const mesh::Nodes10& nodes, const Elastic& elastic) {
  static const std::vector<Sample> straight = sampled(2), curved = sampled(5);
  Stiffness10 stiffness = Stiffness10::Zero();
  for (const Sample& sample : mesh::is_straight(nodes) ? straight : curved) {
    const Eigen::Matrix3d jacobian = mesh::jacobian10(nodes, sample.reference_gradient);
    const Gradient10 gradient = sample.reference_gradient * jacobian.inverse().transpose();
    add_stiffness<10>(stiffness, gradient, elastic, sample.weight * jacobian.determinant() / 6);
  }
  return stiffness;
}

Mass10 consistent_mass10(const mesh::Nodes10& nodes, double density_kg_m3) {
  static const Mass10 per_volume = straight_mass_per_volume();
  static const std::vector<Sample> curved = sampled(7);
  if (mesh::is_straight(nodes)) return density_kg_m3 * volume4(nodes.topRows<4>()) * per_volume;
  Mass10 mass = Mass10::Zero();
  for (const Sample& sample : curved) {
    const double volume = mesh::jacobian10(nodes, sample.reference_gradient).determinant() / 6;
    mass += density_kg_m3 * sample.weight * volume * sample.shape * sample.shape.transpose();
  }
  return mass;
}

} // namespace ringdown::fem
