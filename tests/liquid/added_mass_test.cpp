// The mass of liquid that moves along, against closed forms.
#include "engine/dense/decompositions.h"
#include "engine/liquid/potential.h"
#include "tests/liquid/turned_vessel.h"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace ringdown::liquid {
namespace {

using Eigen::Vector3d;
using Line = std::vector<std::pair<double, double>>;

constexpr double kPi = std::numbers::pi;

Line arc(double radius, double from, double to, int parts) {
  Line line;
  for (int i = 0; i <= parts; ++i) {
    const double angle = from + (to - from) * i / parts;
    const bool on_axis = std::abs(std::cos(angle)) < 1e-12;
    line.emplace_back(on_axis ? 0.0 : radius * std::cos(angle), radius * std::sin(angle));
  }
  return line;
}

// A thick bowl whose inside is a half sphere of radius 1 about the origin, open above.
mesh::TriangleMesh half_sphere_bowl() {
  Line line = arc(1.2, -kPi / 2, 0, 24);
  const Line inside = arc(1, 0, -kPi / 2, 48);
  line.insert(line.end(), inside.begin(), inside.end());
  return turned(line, 0.05, 144);
}

// A cup with a flat bottom: radius 1 inside, floor at the height 0.
mesh::TriangleMesh cup(double height) {
  return turned({{0, -0.1}, {1.1, -0.1}, {1.1, height}, {1, height}, {1, 0}, {0, 0}}, 0.05, 144);
}

mesh::TriangleMesh cavity_in_sphere() {
  mesh::TriangleMesh inside = turned(arc(1, -kPi / 2, kPi / 2, 96), 1, 144);
  inside.triangles.col(1).swap(inside.triangles.col(2));
  return together({turned(arc(1.2, -kPi / 2, kPi / 2, 24), 1, 48), inside});
}

// Displacements of the skin's nodes for motions given as functions of the place.
Eigen::MatrixXd shapes_of(const Skin& skin, const std::vector<std::function<Vector3d(const Vector3d&)>>& motions) {
  Eigen::MatrixXd shapes(3 * skin.surface.nodes.rows(), static_cast<Eigen::Index>(motions.size()));
  for (Eigen::Index n = 0; n < skin.surface.nodes.rows(); ++n) {
    for (std::size_t m = 0; m < motions.size(); ++m)
      shapes.block<3, 1>(3 * n, static_cast<Eigen::Index>(m)) = motions[m](skin.surface.nodes.row(n).transpose());
  }
  return shapes;
}

const std::vector<std::function<Vector3d(const Vector3d&)>> kTranslations = {
    [](const Vector3d&) { return Vector3d(1, 0, 0); }, [](const Vector3d&) { return Vector3d(0, 1, 0); },
    [](const Vector3d&) { return Vector3d(0, 0, 1); }};

struct Filled {
  Skin skin;
  Vector3d up;
  double level = 0;
  Wetted liquid;
  Basin basin;
  Filled(mesh::TriangleMesh surface, double at, const Vector3d& upward = {0, 0, 1})
      : skin(flat_skin(std::move(surface))), up(upward) {
    const WetWall wall(skin, up);
    const std::vector<Basin> basins = basins_of(wall);
    EXPECT_FALSE(basins.empty());
    if (basins.empty()) return;
    basin = basins.front();
    level = at;
    liquid = wetted_by(wall, {piece_of(wall, basin, level)}, level, false);
  }
  [[nodiscard]] Potential potential(const Eigen::MatrixXd& shapes, int nodes = 1000) const {
    const Result<WetPanels> panels = WetPanels::of(liquid, nodes, 1);
    EXPECT_TRUE(panels) << panels.error().message;
    return panels ? panels->potential_of(flow_of(liquid, skin, shapes)) : Potential{};
  }
};

// Solid harmonics of the degrees 1 to 4 and their gradients, odd in z. On a sphere of radius a, a wall that moves with
// the normal velocity Y has the potential a / n Y inside.
struct Harmonic {
  int degree;
  std::function<double(const Vector3d&)> value;
};
const std::vector<Harmonic> kOddHarmonics = {
    {1, [](const Vector3d& x) { return x.z(); }},
    {2, [](const Vector3d& x) { return x.x() * x.z(); }},
    {3, [](const Vector3d& x) { return x.z() * (x.x() * x.x() - x.y() * x.y()); }},
    {4, [](const Vector3d& x) { return x.z() * (x.x() * x.x() * x.x() - 3 * x.x() * x.y() * x.y()); }}};

std::vector<std::function<Vector3d(const Vector3d&)>> radial_motions(double radius) {
  std::vector<std::function<Vector3d(const Vector3d&)>> motions;
  for (const Harmonic& harmonic : kOddHarmonics)
    motions.push_back([value = harmonic.value, radius](const Vector3d& x) -> Vector3d {
      return std::abs(x.norm() - radius) < 1e-9 ? Vector3d(value(x) * x.normalized()) : Vector3d::Zero();
    });
  return motions;
}

TEST(AddedMass, HalfSphereWithAFreeSurfaceIsAnOddSphere) {
  const Filled filled(half_sphere_bowl(), 0.0);
  const Eigen::MatrixXd shapes = shapes_of(filled.skin, radial_motions(1));
  const Potential potential = filled.potential(shapes);
  const Eigen::MatrixXd flow = flow_of(filled.liquid, filled.skin, shapes);
  for (int m = 0; m < 4; ++m) {
    const double square = (flow.col(m).array().square() / filled.liquid.areas.array()).sum();
    EXPECT_NEAR(potential.added_mass(m, m) / square * kOddHarmonics[m].degree, 1, 0.005) << "degree " << m + 1;
  }
  EXPECT_LT(potential.asymmetry, 0.01);
}

TEST(AddedMass, FullSphereHasTheRadiusOverTheDegree) {
  const Filled filled(cavity_in_sphere(), 1.5);
  ASSERT_FALSE(filled.liquid.open);
  const Eigen::MatrixXd shapes = shapes_of(filled.skin, radial_motions(1));
  const Potential potential = filled.potential(shapes);
  const Eigen::MatrixXd flow = flow_of(filled.liquid, filled.skin, shapes);
  for (int m = 0; m < 4; ++m) {
    const double square = (flow.col(m).array().square() / filled.liquid.areas.array()).sum();
    EXPECT_NEAR(potential.added_mass(m, m) / square * kOddHarmonics[m].degree, 1, 0.005) << "degree " << m + 1;
  }
}

// P = r^2/2 - 3/10.
TEST(AddedMass, ClosedSphereThatBreathesMovesItsLiquidAlikeEverywhere) {
  const Filled filled(cavity_in_sphere(), 1.5);
  const Potential potential = filled.potential(shapes_of(
      filled.skin, {[](const Vector3d& x) -> Vector3d { return x.norm() < 1.1 ? x.normalized() : Vector3d::Zero(); }}));
  EXPECT_NEAR(potential.added_mass(0, 0), 4 * kPi / 5, 0.005 * 4 * kPi / 5);
}

TEST(AddedMass, ClosedFullVesselMovesWithAllItsLiquid) {
  const Filled filled(cavity_in_sphere(), 1.5);
  const Potential potential = filled.potential(shapes_of(filled.skin, kTranslations));
  const double volume = 4 * kPi / 3;
  EXPECT_NEAR(filled.basin.volume, volume, 0.003 * volume);
  EXPECT_LT((potential.added_mass - volume * Eigen::Matrix3d::Identity()).norm(), 0.005 * volume);
}

double slope_ratio(int m, double k) {  // I_m / (k I_m')
  const double below = std::cyl_bessel_i(m - 1.0, k), above = std::cyl_bessel_i(m + 1.0, k);
  return std::cyl_bessel_i(static_cast<double>(m), k) / (k * (below + above) / 2);
}

// The wall of a cup moves with cos(m t) cos(k z), k = pi/2h or 3 pi/2h; its floor rests.
TEST(AddedMass, StandingWavesOfACupHaveTheirClosedForm) {
  const double h = 1.5;
  const Filled filled(cup(2), h);
  std::vector<std::function<Vector3d(const Vector3d&)>> motions;
  for (const double k : {kPi / (2 * h), 3 * kPi / (2 * h)}) {
    for (int m = 2; m <= 4; ++m)
      motions.push_back([m, k](const Vector3d& x) -> Vector3d {
        if (std::abs(std::hypot(x.x(), x.y()) - 1) > 1e-9) return Vector3d::Zero();
        return std::cos(m * std::atan2(x.y(), x.x())) * std::cos(k * x.z()) * Vector3d(x.x(), x.y(), 0);
      });
  }
  const Eigen::MatrixXd shapes = shapes_of(filled.skin, motions), flow = flow_of(filled.liquid, filled.skin, shapes);
  const Potential potential = filled.potential(shapes, 1200);
  for (int i = 0; i < 6; ++i) {
    const double square = (flow.col(i).array().square() / filled.liquid.areas.array()).sum();
    const double exact = slope_ratio(2 + i % 3, (i < 3 ? 1 : 3) * kPi / (2 * h));
    EXPECT_NEAR(potential.added_mass(i, i) / (square * exact), 1, 0.005) << i;
  }
}

// The wall moves with cos(m t) (z/h)^2: the sum of its standing waves. It moves most where it meets the surface, and
// there the error lies; it falls with the square of the panels' size.
TEST(AddedMass, CupThatBendsAsASquareHasTheSeriesOfItsStandingWaves) {
  const double h = 1.5;
  const Filled filled(cup(2), h);
  std::vector<std::function<Vector3d(const Vector3d&)>> motions;
  for (int m = 2; m <= 4; ++m) {
    motions.push_back([m, h](const Vector3d& x) -> Vector3d {
      if (std::abs(std::hypot(x.x(), x.y()) - 1) > 1e-9) return Vector3d::Zero();
      return std::cos(m * std::atan2(x.y(), x.x())) * std::pow(x.z() / h, 2) * Vector3d(x.x(), x.y(), 0);
    });
  }
  const Eigen::MatrixXd shapes = shapes_of(filled.skin, motions);
  const Eigen::MatrixXd coarse = filled.potential(shapes, 1000).added_mass,
                        fine = filled.potential(shapes, 2000).added_mass;
  for (int m = 2; m <= 4; ++m) {
    double exact = 0;
    for (int j = 1; j <= 200; ++j) {
      const double k = (2 * j - 1) * kPi / (2 * h), sine = j % 2 == 1 ? 1 : -1;  // sin(k h); cos(k h) = 0
      const double share = std::sqrt(2 / h) * sine * (1 / k - 2 / (k * k * k * h * h));
      exact += kPi * share * share * slope_ratio(m, k);
    }
    const Eigen::Index i = m - 2;
    EXPECT_NEAR(fine(i, i) / exact, 1, 0.015) << m;
    EXPECT_NEAR((2 * fine(i, i) - coarse(i, i)) / exact, 1, 0.005) << m;
  }
}

// In any vessel at any level, also a tilted one, P = z - h for a motion along the vertical.
TEST(AddedMass, VesselMovedAlongTheVerticalCarriesAllItsLiquid) {
  for (const Vector3d& up : {Vector3d(0, 0, 1), Vector3d(0.2, -0.1, 1).normalized()}) {
    for (const double level : {-0.6, -0.3}) {
      const Filled filled(half_sphere_bowl(), level, up);
      const Potential potential = filled.potential(shapes_of(filled.skin, {[&up](const Vector3d&) { return up; }}));
      const double h = 1 + level, volume = kPi * h * h * (3 - h) / 3;
      EXPECT_NEAR(potential.added_mass(0, 0), volume, 0.004 * volume) << level;
    }
  }
}

TEST(AddedMass, GrowsWithTheLevelAndIsNeverNegative) {
  Eigen::MatrixXd last;
  for (const double level : {-0.7, -0.4, -0.1}) {
    const Filled filled(half_sphere_bowl(), level);
    std::vector<std::function<Vector3d(const Vector3d&)>> motions = kTranslations;
    for (const auto& motion : radial_motions(1)) motions.push_back(motion);
    const Eigen::MatrixXd mass = filled.potential(shapes_of(filled.skin, motions)).added_mass;
    const double norm = mass.norm();
    const Eigen::MatrixXd more = last.size() > 0 ? Eigen::MatrixXd(mass - last) : mass;
    EXPECT_GE(dense::eigenvalues(more)[0], -1e-6 * norm) << level;
    last = mass;
  }
}

}  // namespace
}  // namespace ringdown::liquid
