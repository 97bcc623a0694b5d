// Sound bodies that are hard on elements, factors or iteration: each bakes within its stated error of a truth that no
// finite element had a part in.
#include "tests/stress/claims.h"
#include "tests/stress/hard_meshes.h"
#include "tests/stress/ritz.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

namespace ringdown {
namespace {

using test::Body;
using test::Cells;

const Eigen::Vector3d kBlock(0.1, 0.08, 0.06);
const char* const kRitz = "Rayleigh-Ritz";

struct Case {
  std::string name;
  std::function<Body()> body;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::vector<double> block_truth(const modal::Material& material = test::kSteel) {
  return test::box_frequencies(kBlock, test::elastic(material), 24);
}

std::vector<double> slender_truth(const Eigen::Vector3d& size, const Eigen::Vector3i& degree, std::size_t count) {
  return test::box_frequencies(size, test::elastic(test::kSteel), degree, degree.sum(), count);
}

// Shapes of elements --------------------------------------------------------------------------------------------------

Case slivers(double degree, const std::string& written) {
  return {"slivers " + written, [=] {
            return Body{.name = "slivers of " + written + " degree",
                        .hard = "15 flat slivers across a block",
                        .mesh = test::box_with_slivers({5, 3, 4}, kBlock, degree),
                        .truth_hz = block_truth(),
                        .limit = 1e-3,
                        .oracle = kRitz};
          }};
}

Body flat_elements() {
  const mesh::TetMesh box = test::box_mesh({5, 4, 3}, kBlock);
  return {"flat elements 1:1000",
          "a layer of cells 0.02 mm thick in a block",
          test::with_thin_layer(box, 2, 3, 1e-3),
          block_truth(),
          1e-3,
          kRitz};
}

Body needles() {
  const mesh::TetMesh box = test::box_mesh({5, 5, 3}, kBlock);
  return {"needles 1:1000",
          "a column of cells 0.02 x 0.016 x 20 mm, and two layers of 0.02 mm",
          test::with_thin_layer(test::with_thin_layer(box, 0, 5, 1e-3), 1, 5, 1e-3),
          block_truth(),
          1e-3,
          kRitz};
}

Body one_element(int order) {
  const mesh::TetMesh mesh = test::one_element(order);
  return {.name = "1 element of order " + std::to_string(order),
          .hard = std::to_string(mesh.nodes.rows()) + " nodes",
          .mesh = mesh,
          .truth_hz = test::tetrahedron_frequencies(mesh::corners_of(mesh, 0), test::elastic(test::kSteel), order, 99),
          .limit = 1e-9,
          .oracle = "Rayleigh-Ritz of the same degree",
          .element = test::element_of(mesh),
          .min_modes = order == 1 ? std::size_t{5} : std::size_t{10}};
}

// Thin bodies ---------------------------------------------------------------------------------------------------------

Body thin_plate(int cells, double limit, double shortfall) {
  return {.name = "plate 1:500",
          .hard = "0.5 x 0.5 x 0.001 m, one layer of cells " + std::to_string(500 / cells) + ":1",
          .mesh = test::box_mesh({cells, cells, 1}, {0.5, 0.5, 0.001}),
          .truth_hz = slender_truth({0.5, 0.5, 0.001}, {20, 20, 3}, 24),
          .limit = limit,
          .oracle = kRitz,
          .shortfall = shortfall};
}

// Pairs of bending modes of a free, square bar: Euler-Bernoulli, lowered by shear and rotary inertia to first order
// (Timoshenko, Phil. Mag. 41, 1921).
std::vector<double> slender_beam(double length, double side, int pairs) {
  const auto [e, nu, rho] = test::elastic(test::kSteel);
  const double radius = side / std::sqrt(12.0);  // of gyration
  std::vector<double> frequencies;
  for (int n = 1; n <= pairs; ++n) {
    const std::array<double, 2> first = {4.730040745, 7.853204624};  // roots of cos(x) cosh(x) = 1
    const double k = (n <= 2 ? first[n - 1] : (n + 0.5) * std::numbers::pi) / length;
    const double euler = k * k * radius * std::sqrt(e / rho) / (2 * std::numbers::pi);
    frequencies.insert(frequencies.end(), 2, euler / std::sqrt(1 + std::pow(k * radius, 2) * (1 + 2.4 * (1 + nu))));
  }
  return frequencies;
}

Body wire() {
  return {"wire 1:1000",
          "1 x 0.001 x 0.001 m, cells 25:1",
          test::box_mesh({40, 1, 1}, {1, 0.001, 0.001}),
          slender_beam(1, 0.001, 8),
          3e-4,
          "Timoshenko's beam"};
}

// Before the solver was told how many motions are rigid, the two lowest of these modes were taken for such.
Body wire_with_slivers() {
  return {.name = "wire 1:1000 with slivers",
          .hard = "41 slivers of 0.01 degree, 5 Hz in a band of 2 kHz",
          .mesh = test::box_with_slivers({41, 1, 2}, {1, 0.001, 0.001}, 0.01),
          .truth_hz = slender_truth({1, 0.001, 0.001}, {50, 3, 3}, 80),
          .limit = 2e-2,
          .oracle = kRitz,
          .min_modes = 56,
          .shortfall = 1.8};
}

// Modes of a thin spherical shell without torsion, 2n+1 of each frequency: with L = n (n + 1), b = h^2 / (12 R^2) and
// x = (1 - nu^2) rho (omega R)^2 / E, the smaller root of
//   x^2 - (1 + 3 nu + L - b (1 - nu - L^2 - nu L)) x
//     + (L - 2) (1 - nu^2) + b (L^3 - 4 L^2 + (5 - nu^2) L - 2 (1 - nu^2)) = 0
// (Junger & Feit, Sound, Structures, and Their Interaction, 1986, chapter 7; Lamb's membrane of 1882 where b = 0).
std::vector<double> thin_sphere(double radius, double wall, int last) {
  const auto [e, nu, rho] = test::elastic(test::kSteel);
  const double plane = 1 - nu * nu, b = std::pow(wall / radius, 2) / 12;
  std::vector<double> frequencies;
  for (int n = 2; n <= last; ++n) {
    const double l = n * (n + 1);
    const double linear = 1 + 3 * nu + l - b * (1 - nu - l * l - nu * l);
    const double constant = (l - 2) * plane + b * (l * l * l - 4 * l * l + (5 - nu * nu) * l - 2 * plane);
    const double x = (linear - std::sqrt(linear * linear - 4 * constant)) / 2;
    frequencies.insert(frequencies.end(), 2 * n + 1, std::sqrt(x * e / rho / plane) / (2 * std::numbers::pi * radius));
  }
  return frequencies;
}

Body shell(int level, std::size_t min, double shortfall) {
  return {.name = "shell 1:500",
          .hard = "hollow sphere, radius 0.1 m, wall 0.2 mm; families of 2n+1",
          .mesh = test::hollow_sphere(0.0999, 0.1001, level, 3),
          .truth_hz = thin_sphere(0.1, 0.0002, 8),
          .limit = 1e-3,
          .oracle = "Junger & Feit's thin shell",
          .min_modes = min,
          .shortfall = shortfall};
}

// Materials, sizes, places --------------------------------------------------------------------------------------------

Case poisson(double nu, const std::string& written) {
  return {"nu " + written, [=] {
            modal::Material material = test::kSteel;
            material.poisson_ratio = nu;
            return Body{.name = "nu = " + written,
                        .hard = nu > 0.48 ? "nearly incompressible" : "Poisson's ratio",
                        .mesh = test::box_mesh({5, 4, 3}, kBlock),
                        .truth_hz = block_truth(material),
                        .limit = 1.5e-3,
                        .oracle = kRitz,
                        .material = material};
          }};
}

Body two_pieces() {
  mesh::TetMesh other = test::box_mesh({4, 4, 4}, {0.09, 0.07, 0.07});
  other.nodes.col(0).array() += 0.2;
  std::vector<double> truth = block_truth();
  const auto more = test::box_frequencies({0.09, 0.07, 0.07}, test::elastic(test::kSteel), 24);
  truth.insert(truth.end(), more.begin(), more.end());
  std::sort(truth.begin(), truth.end());
  return {.name = "two pieces",
          .hard = "12 rigid motions; the modes of two blocks, which mix nowhere",
          .mesh = test::both(test::box_mesh({5, 4, 3}, kBlock), other),
          .truth_hz = truth,
          .limit = 1e-3,
          .oracle = kRitz,
          .rigid = 12};
}

Body many_elements() {
  return {.name = "302,400 elements",
          .hard = "tet4, a narrow band",
          .mesh = test::box_mesh({40, 36, 35}, kBlock),
          .truth_hz = block_truth(),
          .limit = 1e-2,
          .oracle = kRitz,
          .element = fem::Element::kTet4};
}

std::vector<Case> cases() {
  std::vector<Case> all = {slivers(10, "10"),
                           slivers(1, "1"),
                           slivers(0.1, "0.1"),
                           slivers(1e-6, "0.000001"),
                           {"flat", flat_elements},
                           {"needles", needles},
                           {"wire", wire},
                           {"wire with slivers", wire_with_slivers},
                           {"plate", [] { return thin_plate(10, 2e-3, 9); }},
                           {"shell", [] { return shell(1, 12, 1); }},
                           poisson(-0.5, "-0.5"),
                           poisson(0, "0"),
                           poisson(0.3, "0.3"),
                           poisson(0.49, "0.49"),
                           poisson(0.499, "0.499"),
                           poisson(0.4999, "0.4999"),
                           poisson(0.499999, "0.499999"),
                           {"two pieces", two_pieces}};
  for (int order = 1; order <= 4; ++order) all.push_back({"one element", [order] { return one_element(order); }});
  if (test::long_form()) {
    all.push_back({"finer plate", [] { return thin_plate(20, 5e-4, 1.5); }});
    all.push_back({"finer shell", [] { return shell(2, 45, 2.5); }});
    all.push_back({"many elements", many_elements});
  }
  return all;
}

class HardBody : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Stress, HardBody, testing::ValuesIn(cases()));

TEST_P(HardBody, AHardBodyBakesWholeAndWithinItsStatedError) { test::expect_baked(GetParam().body()); }

// Laws of scale -------------------------------------------------------------------------------------------------------

struct Scale {
  const char* name;
  const char* hard;
  double size = 1, stiffness = 1, density = 1;  // times those of the steel block
  double away_m = 0;
};

void PrintTo(const Scale& scale, std::ostream* out) { *out << scale.name; }

class ScaledBody : public testing::TestWithParam<Scale> {};
INSTANTIATE_TEST_SUITE_P(
    Stress, ScaledBody,
    testing::Values(Scale{.name = "1 mm", .hard = "size; f ~ 1 / L", .size = 0.01},
                    Scale{.name = "100 m", .hard = "size; f ~ 1 / L", .size = 1000},
                    Scale{.name = "E = 1e4 Pa", .hard = "f ~ sqrt(E)", .stiffness = 1e4 / 200e9},
                    Scale{.name = "E = 1e12 Pa", .hard = "f ~ sqrt(E)", .stiffness = 5},
                    Scale{.name = "1 kg/m^3", .hard = "f ~ 1 / sqrt(rho)", .density = 1 / 7850.0},
                    Scale{.name = "22,600 kg/m^3", .hard = "f ~ 1 / sqrt(rho)", .density = 22600 / 7850.0},
                    Scale{.name = "1 km from the origin", .hard = "a block 0.14 m long", .away_m = 1000}));

TEST_P(ScaledBody, AScaledBodyRingsAtExactlyScaledFrequencies) {
  const auto& [name, hard, size, stiffness, density, away_m] = GetParam();
  const mesh::TetMesh block = test::box_mesh({3, 2, 2}, kBlock);
  Body scaled{.name = name, .hard = hard, .mesh = block, .limit = 1e-9, .oracle = "the steel block, scaled"};
  scaled.mesh.nodes = (size * block.nodes).array() + away_m;
  scaled.material.youngs_modulus_pa *= stiffness;
  scaled.material.density_kg_m3 *= density;
  test::expect_like(scaled, block, 40e3, std::sqrt(stiffness / density) / size);
}

}  // namespace
}  // namespace ringdown
