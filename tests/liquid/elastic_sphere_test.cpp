// A thin elastic sphere full of a liquid that gives way, against its frequency equation (Lamb 1882; Junger & Feit,
// Sound, Structures, and Their Interaction, chapter 7, for membranes): with w = W P_n along the normal and u = U
// dP_n/dtheta
//
//   | 2 (1 + nu) K - omega^2 (rho_s h a^2 + rho a^3 j_n(x) / (x j_n'(x)))   -l (1 + nu) K | | -l (1 + nu) K l (l - 1 +
//   nu) K - omega^2 l rho_s h a^2     | = 0
//
// with K = E h / (1 - nu^2), l = n (n + 1) and x = omega a / c.
#include "engine/liquid/potential.h"
#include "engine/liquid/water_modes.h"
#include "engine/liquid/wet_modes.h"
#include "tests/liquid/turned_vessel.h"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace ringdown::liquid::elastic_sphere_test {
namespace {

constexpr double kPi = std::numbers::pi;
// A shell of aluminium, 1 m in radius and 10 mm thick, full of water.
constexpr double kModulus = 70e9, kPoisson = 0.33, kShell = 2700, kThick = 0.01, kWater = 998.2, kSound = 1482;
constexpr double kStiff = kModulus * kThick / (1 - kPoisson * kPoisson), kMass = kShell * kThick;

double legendre(int n, double x) { return std::legendre(static_cast<unsigned>(n), x); }

// The frequency equation times x j_n'(x), which has no poles.
double equation(int n, double omega) {
  const double x = omega / kSound, l = n * (n + 1.0);
  const double j = std::sph_bessel(static_cast<unsigned>(n), x);
  const double slope = n * j - x * std::sph_bessel(static_cast<unsigned>(n) + 1, x);  // x j_n'
  const double square = omega * omega;
  const double radial = slope * (2 * (1 + kPoisson) * kStiff - square * kMass) - square * kWater * j;
  if (n == 0) return radial;
  return radial * ((l - 1 + kPoisson) * kStiff - square * kMass) -
         slope * l * (1 + kPoisson) * (1 + kPoisson) * kStiff * kStiff;
}

std::vector<double> roots(int n, double highest) {
  constexpr double kFirst = 10, kStep = 5;
  std::vector<double> found;
  for (double omega = kFirst; omega < highest; omega += kStep) {
    double low = omega, high = omega + kStep;
    if (equation(n, low) * equation(n, high) > 0) continue;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (equation(n, low) * equation(n, middle) > 0 ? low : high) = middle;
    }
    found.push_back(low);
  }
  return found;
}

// The modes of the empty shell of one degree: their eigenvalues, and W of unit mass.
struct DryModes {
  std::vector<double> lambda, radial;
};

DryModes dry_modes(int n) {
  const double norm = 2 * kPi * 2 / (2 * n + 1), l = n * (n + 1.0);
  if (n == 0) return {{2 * (1 + kPoisson) * kStiff / kMass}, {1 / std::sqrt(norm * kMass)}};
  // Symmetric in W and V = sqrt(l) U.
  Eigen::Matrix2d matrix;
  matrix << 2 * (1 + kPoisson), -std::sqrt(l) * (1 + kPoisson), -std::sqrt(l) * (1 + kPoisson), l - 1 + kPoisson;
  matrix *= kStiff / kMass;
  const double mean = matrix.trace() / 2, spread = std::hypot((matrix(0, 0) - matrix(1, 1)) / 2, matrix(0, 1));
  DryModes modes;
  for (const double lambda : {std::max(mean - spread, 0.0), mean + spread}) {
    const double w = matrix(0, 1), v = lambda - matrix(0, 0);
    modes.lambda.push_back(lambda);
    modes.radial.push_back(w / std::hypot(w, v) / std::sqrt(norm * kMass));
  }
  return modes;
}

Skin cavity() {
  std::vector<std::pair<double, double>> line;
  for (int i = 0; i <= 96; ++i) {
    const double angle = kPi * (i / 96.0 - 0.5);
    line.emplace_back(i % 96 == 0 ? 0.0 : std::cos(angle), std::sin(angle));
  }
  std::vector<std::pair<double, double>> outside = line;
  for (auto& [radius, height] : outside) radius *= 1.2, height *= 1.2;
  mesh::TriangleMesh inside = turned(line, 1, 144);
  inside.triangles.col(1).swap(inside.triangles.col(2));
  return flat_skin(together({turned(outside, 1, 48), inside}));
}

TEST(ElasticSphere, FullOfWaterItRingsByLambsEquation) {
  constexpr int kDegrees = 4;
  constexpr double kHighest = 2 * kPi * 900;
  const Skin skin = cavity();
  const WetWall wall(skin, {0, 0, 1});
  const Wetted liquid = wetted_by(wall, {piece_of(wall, basins_of(wall).front(), 1.5)}, 1.5, false);
  ASSERT_FALSE(liquid.open);
  const Result<WetPanels> panels = WetPanels::of(liquid, 1500, 1);
  ASSERT_TRUE(panels) << panels.error().message;
  const WaterModes water(liquid, panels->panels());
  for (int n = 0; n < kDegrees; ++n) {
    const DryModes dry = dry_modes(n);
    const auto count = static_cast<Eigen::Index>(dry.lambda.size());
    Eigen::MatrixXd shapes = Eigen::MatrixXd::Zero(3 * skin.surface.nodes.rows(), count);
    for (Eigen::Index p = 0; p < skin.surface.nodes.rows(); ++p) {
      const Eigen::Vector3d at = skin.surface.nodes.row(p).transpose();
      if (at.norm() > 1.1) continue;
      for (Eigen::Index m = 0; m < count; ++m)
        shapes.block<3, 1>(3 * p, m) = dry.radial[m] * legendre(n, at.z() / at.norm()) * at.normalized();
    }
    const Eigen::MatrixXd flow = flow_of(liquid, skin, shapes), bound = flow.transpose() * water.values(liquid.at);
    Coupled coupled;
    coupled.stiffness = Eigen::Map<const Eigen::VectorXd>(dry.lambda.data(), count).asDiagonal();
    coupled.stiffness += kWater * kSound * kSound * bound.col(0) * bound.col(0).transpose();
    coupled.mass = Eigen::MatrixXd::Identity(count, count) + kWater * panels->potential_of(flow).added_mass;
    const Eigen::Index own = (water.wavenumbers().array() < 4 * kHighest / kSound).count() - 1;
    const Eigen::VectorXd kappa = water.wavenumbers().segment(1, own);
    coupled.own_lambda = (kSound * kappa).array().square();
    coupled.bond = std::sqrt(kWater) * bound.middleCols(1, own) * kappa.cwiseInverse().asDiagonal();
    const Result<WetModes> wet = wet_modes_of(coupled);
    ASSERT_TRUE(wet) << wet.error().message;
    const std::vector<double> exact = roots(n, kHighest);
    ASSERT_FALSE(exact.empty()) << n;
    for (const double omega : exact) {
      double nearest = 1e9;
      for (const double lambda : wet->lambda)
        nearest = std::min(nearest, std::abs(std::sqrt(std::max(lambda, 0.0)) - omega));
      EXPECT_LT(nearest / omega, 0.003) << "degree " << n << " at " << omega / (2 * kPi) << " Hz";
    }
  }
}

}  // namespace
}  // namespace ringdown::liquid::elastic_sphere_test
