// Bodies that something holds, against closed forms and Rayleigh-Ritz.
#include "engine/fem/error_estimate.h"
#include "engine/fem/holding.h"
#include "engine/solve/eigensolver.h"
#include "tests/fem/grain_frequencies.h"
#include "tests/fem/sample_meshes.h"

#include <gtest/gtest.h>

#include <numbers>
#include <span>

namespace ringdown::held_test {
namespace {

constexpr fem::Elastic kSteelBar{200e9, 0.3, 7850};
constexpr double kPi = std::numbers::pi;

// The outer faces whose nodes have coordinate `axis` equal to `at`.
std::vector<mesh::OuterFace> faces_at(const mesh::TetMesh& mesh, int axis, double at) {
  std::vector<mesh::OuterFace> found;
  for (const mesh::OuterFace& face : mesh::outer_faces(mesh.elements)) {
    bool there = true;
    for (const std::int32_t n : fem::nodes_on(mesh, {face})) there = there && std::abs(mesh.nodes(n, axis) - at) < 1e-9;
    if (there) found.push_back(face);
  }
  return found;
}

struct HeldModes {
  Eigen::VectorXd lambda, errors;
  Eigen::MatrixXd shapes;
  int rigid = 0, counted = 0;
};

HeldModes solve_held(const mesh::TetMesh& mesh, const fem::Solid& solid, const fem::Holding& holding, double top_hz) {
  fem::System whole = fem::assemble(mesh, solid, test::element_of(mesh)).value(), left;
  fem::add_layers(mesh, holding, whole);
  const std::vector<std::int32_t> clamped = fem::nodes_on(mesh, holding.clamped);
  if (!clamped.empty()) fem::remove_nodes(clamped, whole, left);
  const int free = fem::free_motions(mesh, holding);
  const auto modes = solve::solve_modes(clamped.empty() ? whole : left,
                                        {.highest_lambda = std::pow(2 * kPi * top_hz, 2), .rigid = free});
  EXPECT_TRUE(modes) << modes.error().message;
  HeldModes held{.rigid = modes->rigid, .counted = modes->counted};
  const Eigen::Index elastic = modes->lambda.size() - held.rigid;
  held.lambda = modes->lambda.tail(elastic);
  held.shapes = fem::with_nodes(modes->shapes.rightCols(elastic), clamped);
  held.errors = fem::frequency_errors(mesh, solid, held.lambda, held.shapes, 0, holding).value();
  return held;
}

void expect_frequencies(const HeldModes& found, std::span<const double> exact, double within) {
  ASSERT_GE(found.lambda.size(), static_cast<Eigen::Index>(exact.size()));
  double off = 0;
  for (std::size_t m = 0; m < exact.size(); ++m) {
    const double hz = std::sqrt(found.lambda[static_cast<Eigen::Index>(m)]) / (2 * kPi);
    off = std::max(off, std::abs(hz / exact[m] - 1));
  }
  std::printf("%zu modes within %.1e, estimated %.1e\n", exact.size(), off,
              found.errors.head(static_cast<Eigen::Index>(exact.size())).maxCoeff());
  EXPECT_LT(off, within);
}

TEST(Held, ACantileverHasTheFrequenciesOfRayleighRitz) {
  const mesh::TetMesh bar =
      mesh::to_order(test::finer_at_ends(test::box_mesh({16, 2, 2}, {0.2, 0.02, 0.01}), 0, false), 4);
  const HeldModes found = solve_held(bar, kSteelBar, {.clamped = faces_at(bar, 0, 0)}, 27000);
  EXPECT_EQ(found.rigid, 0);
  expect_frequencies(found, reference::kSteelCantilever, 1e-3);
}

TEST(Held, ASpruceCantileverHasTheFrequenciesOfRayleighRitz) {
  const mesh::TetMesh bar =
      mesh::to_order(test::finer_at_ends(test::box_mesh({26, 4, 2}, {0.2, 0.02, 0.01}), 0, false), 4);
  const fem::EngineeringConstants spruce{{11e9, 0.86e9, 0.47e9}, {0.37, 0.47, 0.44}, {0.70e9, 0.67e9, 0.033e9}};
  const fem::Solid solid({fem::Law{{1, 0, 430}, fem::orthotropic_stiffness(spruce).value()}}, {});
  expect_frequencies(solve_held(bar, solid, {.clamped = faces_at(bar, 0, 0)}, 13500), reference::kSpruceCantilever,
                     1e-3);
}

TEST(Held, AClampedPlateHasTheFrequenciesOfRayleighRitz) {
  const mesh::TetMesh plate = mesh::to_order(
      test::finer_at_ends(test::finer_at_ends(test::box_mesh({14, 12, 1}, {0.2, 0.15, 0.006}), 0, true), 1, true), 4);
  fem::Holding holding;
  for (const auto& [axis, at] : {std::pair{0, 0.0}, {0, 0.2}, {1, 0.0}, {1, 0.15}}) {
    const auto faces = faces_at(plate, axis, at);
    holding.clamped.insert(holding.clamped.end(), faces.begin(), faces.end());
  }
  expect_frequencies(solve_held(plate, kSteelBar, holding, 16700), reference::kClampedPlate, 1e-3);
}

// A box whose six faces slide rings in plane waves: for each (l, m, n) one longitudinal one, and as many transverse
// ones as there are directions across that fit: none of one number, one of two, two of three that are not zero; but
// with one only, two shear waves across would need a motion into the walls.
TEST(Held, ABoxThatSlidesOnAllItsFacesRingsInPlaneWaves) {
  const Eigen::Vector3d size(0.1, 0.08, 0.06);
  const mesh::TetMesh box = mesh::to_order(test::box_mesh({3, 3, 2}, size), 4);
  fem::Holding holding;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double at : {0.0, size[axis]}) {
      holding.layers.push_back({.faces = faces_at(box, axis, at),
                                .normal_n_m3 = 1e7 * 200e9 / 0.14,
                                .direction = Eigen::Vector3d::Unit(axis)});
    }
  }
  const double shear = std::sqrt(kSteelBar.mu_pa() / 7850),
               press = std::sqrt((kSteelBar.lambda_pa() + 2 * kSteelBar.mu_pa()) / 7850);
  std::vector<double> exact;
  for (int l = 0; l < 6; ++l) {
    for (int m = 0; m < 6; ++m) {
      for (int n = 0; n < 6; ++n) {
        const int waves = (l > 0) + (m > 0) + (n > 0);
        const double k = Eigen::Vector3d(l / size[0], m / size[1], n / size[2]).norm() / 2;
        if (waves > 0) exact.push_back(press * k);
        for (int i = 1; i < waves; ++i) exact.push_back(shear * k);
      }
    }
  }
  std::sort(exact.begin(), exact.end());
  exact.resize(20);
  const HeldModes found = solve_held(box, kSteelBar, holding, 1.01 * exact.back());
  EXPECT_EQ(found.rigid, 0);
  expect_frequencies(found, exact, 1e-3);
}

// Motions that are left: none when clamped; three on a plane; two along a groove; one in a channel; six with masses
// only.
TEST(Held, RigidMotionsThatAreLeftAreFoundByInertiaToo) {
  const Eigen::Vector3d size(0.1, 0.08, 0.06);
  const mesh::TetMesh box = mesh::to_order(test::box_mesh({2, 2, 2}, size), 2);
  const auto slides = [&](int axis) {
    return fem::Layer{
        .faces = faces_at(box, axis, 0), .normal_n_m3 = 1e7 * 200e9 / 0.14, .direction = Eigen::Vector3d::Unit(axis)};
  };
  const fem::Holding clamped{.clamped = faces_at(box, 2, 0)}, plane{.layers = {slides(2)}},
      groove{.layers = {slides(2), slides(1)}}, corner{.layers = {slides(2), slides(1), slides(0)}},
      mass{.layers = {{.faces = faces_at(box, 2, 0), .mass_kg_m2 = 10}}},
      soft{.layers = {{.faces = faces_at(box, 2, 0), .normal_n_m3 = 1e9, .tangential_n_m3 = 1e9}}};
  for (const auto& [holding, expected] :
       {std::pair{&clamped, 0}, {&plane, 3}, {&groove, 1}, {&corner, 0}, {&mass, 6}, {&soft, 0}}) {
    EXPECT_EQ(fem::free_motions(box, *holding), expected);
    const HeldModes found = solve_held(box, kSteelBar, *holding, 30000);
    EXPECT_EQ(found.rigid, expected);
    EXPECT_GT(found.lambda[0], std::pow(2 * kPi * 100, 2));  // the next is no rigid motion
    EXPECT_EQ(found.counted, expected + found.lambda.size());
  }
  const mesh::TetMesh two = test::both(box, [&] {
    mesh::TetMesh other = box;
    other.nodes.col(0).array() += 1;
    return other;
  }());
  EXPECT_EQ(fem::free_motions(two, {.clamped = faces_at(two, 0, 0)}), 6);
}

// A bar with nu = 0 that slides along its sides is one-dimensional: with a spring of stiffness k at one end
// (per area) E q tan(q L) = k, and with a mass mu there tan(q L) = -mu q / rho, where q = omega sqrt(rho / E).
TEST(Held, ABarOnASpringAndABarWithAMassHaveTheirExactFrequencies) {
  const double length = 0.2, e = 200e9, rho = 7850, c = std::sqrt(e / rho);
  const fem::Elastic bar_law{e, 0, rho};
  // So slender that the mass, which has no stiffness, cannot move to and fro across the end in this band.
  const mesh::TetMesh bar = mesh::to_order(test::box_mesh({16, 1, 1}, {length, 0.002, 0.002}), 4);
  fem::Holding sides;
  for (const auto& [axis, at] : {std::pair{1, 0.0}, {1, 0.002}, {2, 0.0}, {2, 0.002}}) {
    sides.layers.push_back(
        {.faces = faces_at(bar, axis, at), .normal_n_m3 = 1e7 * e / length, .direction = Eigen::Vector3d::Unit(axis)});
  }
  const auto root = [](const auto& f, double low, double high) {
    for (int i = 0; i < 200; ++i) {
      const double middle = 0.5 * (low + high);
      ((f(middle) > 0) == (f(high) > 0) ? high : low) = middle;
    }
    return low;
  };
  const double k = 3 * e / length, mass = 0.1 * rho * length;
  std::vector<double> on_spring, with_mass;
  for (int n = 0; n < 5; ++n) {
    const auto spring = [&](double x) { return e / length * x * std::sin(x) - k * std::cos(x); };
    on_spring.push_back(c / length / (2 * kPi) * root(spring, n * kPi + 1e-9, (n + 0.5) * kPi + 1e-9));
    const auto heavy = [&](double x) { return std::sin(x) + mass / (rho * length) * x * std::cos(x); };
    with_mass.push_back(c / length / (2 * kPi) * root(heavy, (n + 0.5) * kPi + 1e-9, (n + 1) * kPi - 1e-9));
  }
  fem::Holding spring = sides, heavy = sides;
  spring.layers.push_back({.faces = faces_at(bar, 0, length), .normal_n_m3 = k});
  heavy.layers.push_back({.faces = faces_at(bar, 0, length), .mass_kg_m2 = mass});
  EXPECT_EQ(fem::free_motions(bar, spring), 0);
  EXPECT_EQ(fem::free_motions(bar, heavy), 1);
  expect_frequencies(solve_held(bar, bar_law, spring, 1.01 * on_spring.back()), on_spring, 1e-6);
  const HeldModes loaded = solve_held(bar, bar_law, heavy, 1.01 * with_mass.back());
  expect_frequencies(loaded, with_mass, 1e-6);

  // The motion on the end that a damper would meet: of cos(q x) with unit modal mass, the mass included.
  const Eigen::MatrixXd motion = fem::motion_on(bar, heavy.layers.back(), loaded.shapes);
  for (int n = 0; n < 5; ++n) {
    const double x = 2 * kPi * with_mass[n] * length / c, end = std::cos(x) * std::cos(x);
    const double modal = rho * length / 2 * (1 + std::sin(2 * x) / (2 * x)) + mass * end;
    EXPECT_NEAR(motion(0, n) / (end / modal), 1, 1e-6);
    EXPECT_NEAR(motion(1, n), 0, 1e-6 * motion(0, n));
  }
}

// Coarse against fine: the estimate knows springs, masses and clamps, or it would take the pull of each for an error.
TEST(Held, TheErrorEstimateKnowsWhatHoldsABody) {
  const Eigen::Vector3d size(0.1, 0.03, 0.02);
  for (const int kind : {0, 1, 2}) {
    const auto held = [&](const mesh::TetMesh& mesh) {
      fem::Holding holding;
      if (kind == 0) holding.clamped = faces_at(mesh, 0, 0);
      if (kind == 1)
        holding.layers.push_back({.faces = faces_at(mesh, 0, 0), .normal_n_m3 = 1e13, .tangential_n_m3 = 3e12});
      if (kind == 2) holding.layers.push_back({.faces = faces_at(mesh, 0, 0), .mass_kg_m2 = 40});
      return holding;
    };
    const mesh::TetMesh coarse = mesh::to_order(test::box_mesh({4, 1, 1}, size), 2),
                        fine = mesh::to_order(test::box_mesh({10, 3, 2}, size), 4);
    const HeldModes rough = solve_held(coarse, kSteelBar, held(coarse), 30000),
                    truth = solve_held(fine, kSteelBar, held(fine), 30000);
    ASSERT_GE(truth.lambda.size(), 5);
    for (Eigen::Index m = 0; m < 5; ++m) {
      const double error = std::sqrt(rough.lambda[m] / truth.lambda[m]) - 1;
      std::printf("kind %d mode %td: true %.2e estimated %.2e\n", kind, m, error, rough.errors[m]);
      EXPECT_GT(rough.errors[m], 0.4 * error);
      EXPECT_LT(rough.errors[m], 6 * error + 1e-4);
    }
  }
}

}  // namespace
}  // namespace ringdown::held_test
