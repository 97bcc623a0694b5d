// Shapes of a free sphere against the closed form (Lamb, Proc. London Math. Soc. 13, 1882), family by family: which
// basis of a degenerate family a solver returns is chance, the space that it spans is not.
#include "engine/solve/eigensolver.h"

#include "engine/dense/decompositions.h"
#include "engine/mesh/gmsh_reader.h"
#include "tests/fem/reference_frequencies.h"
#include "tests/fem/sample_meshes.h"
#include "tests/support/temporary_folder.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>

namespace ringdown::exact_shapes_test {
namespace {

constexpr fem::Elastic kSteel{200e9, 0.3, 7850};
constexpr double kRadius = 0.1;

using Field = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

// A solid harmonic of degree 2: r^2 times a spherical harmonic.
struct Harmonic {
  Eigen::Matrix3d form;  // symmetric, without trace: H = x^T form x

  [[nodiscard]] double value(const Eigen::Vector3d& x) const { return x.dot(form * x); }
  [[nodiscard]] Eigen::Vector3d gradient(const Eigen::Vector3d& x) const { return 2 * form * x; }
};

std::vector<Harmonic> harmonics() {
  std::vector<Harmonic> all(5, {Eigen::Matrix3d::Zero()});
  all[0].form(0, 1) = all[0].form(1, 0) = all[1].form(1, 2) = all[1].form(2, 1) = 1;
  all[2].form(2, 0) = all[2].form(0, 2) = 1;
  all[3].form.diagonal() << 1, -1, 0;
  all[4].form.diagonal() << -1, -1, 2;
  return all;
}

double wave_number(double frequency_hz, double modulus_pa) {
  return 2 * std::numbers::pi * frequency_hz / std::sqrt(modulus_pa / kSteel.density_kg_m3);
}

// j_2 and its first two derivatives, from Bessel's equation.
struct Bessel {
  explicit Bessel(double x)
      : value(std::sph_bessel(2, x)),
        slope(std::sph_bessel(1, x) - 3 / x * value),
        second(-2 / x * slope + (6 / (x * x) - 1) * value) {}
  double value, slope, second;
};

// Torsional, n = 2: u = j_2(k r) r x grad Y.
Field torsional(const Harmonic& h, double frequency_hz) {
  const double k = wave_number(frequency_hz, kSteel.mu_pa());
  return [=](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    return std::sph_bessel(2, k * x.norm()) / x.squaredNorm() * x.cross(h.gradient(x));
  };
}

// Spheroidal, n = 2: u = A grad(j_2(h r) Y) + B curl curl(x j_2(k r) Y) = U(r) Y e_r + V(r) r grad Y, with B/A such
// that no shear stress, mu (V' - V/r + U/r), is left on the surface.
struct Radial {
  double u, v, v_slope;
};

Radial longitudinal(double h, double r) {
  const Bessel j(h * r);
  return {h * j.slope, j.value / r, h * j.slope / r - j.value / (r * r)};
}

Radial transverse(double k, double r) {
  const Bessel j(k * r);
  return {6 * j.value / r, j.value / r + k * j.slope, k * j.slope / r - j.value / (r * r) + k * k * j.second};
}

Field spheroidal(const Harmonic& harmonic, double frequency_hz) {
  const double h = wave_number(frequency_hz, kSteel.lambda_pa() + 2 * kSteel.mu_pa());
  const double k = wave_number(frequency_hz, kSteel.mu_pa());
  const auto shear = [](const Radial& at) { return at.v_slope - at.v / kRadius + at.u / kRadius; };
  const double b = -shear(longitudinal(h, kRadius)) / shear(transverse(k, kRadius));
  return [=](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    const double r = x.norm(), value = harmonic.value(x) / (r * r);
    const Radial one = longitudinal(h, r), other = transverse(k, r);
    const Eigen::Vector3d outward = x / r;
    return (one.u + b * other.u) * value * outward +
           (one.v + b * other.v) * (harmonic.gradient(x) / r - 2 * value * outward);
  };
}

// The smallest of the squared cosines between the two spaces, in the scalar product of the mass: the modal assurance
// criterion of whole families. 1 when they are the same.
double subspace_mac(const fem::System& system, const Eigen::MatrixXd& shapes, Eigen::MatrixXd exact) {
  Eigen::MatrixXd root = exact.transpose() * fem::mass_times(system.node_mass, exact);
  Eigen::MatrixXd cosines = exact.transpose() * fem::mass_times(system.node_mass, shapes);
  dense::cholesky(root);
  dense::solve_lower(root, cosines);
  return dense::eigenvalues(cosines * cosines.transpose())[0];
}

TEST(ExactShapes, ShapesOfASphereSpanTheClosedForm) {
  const test::TemporaryFolder folder;
  const auto path = folder / "ball.geo";
  std::ofstream(path) << "SetFactory(\"OpenCASCADE\"); DefineConstant[ mesh_size = 0.05 ];\n"
                         "Sphere(1) = {0, 0, 0, 0.1}; MeshSize{ PointsOf{ Volume{1}; } } = mesh_size;\n";
  const auto ball = mesh::read_with_gmsh(path, {.mesh_size_m = 0.05, .order = 3, .parameters = {}});
  ASSERT_TRUE(ball) << ball.error().message;
  const mesh::TetMesh& mesh = ball->mesh;
  const fem::System system = fem::assemble(mesh, kSteel, fem::Element::kTet20).value();
  const auto modes = solve::solve_modes(system, {.highest_lambda = std::pow(2 * std::numbers::pi * 14e3, 2)}).value();
  ASSERT_EQ(modes.lambda.size(), 6 + 5 + 5);

  const auto family = [&](auto&& field) {
    Eigen::MatrixXd exact(system.unknowns(), 5);
    for (int m = 0; m < 5; ++m) {
      const Field u = field(harmonics()[m]);
      for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n) {
        const Eigen::Vector3d at = mesh.nodes.row(n);
        exact.col(m).segment<3>(3 * n) = at.norm() < 1e-9 ? Eigen::Vector3d(0, 0, 0) : u(at);
      }
    }
    return exact;
  };
  const Eigen::MatrixXd twisting = family([](const Harmonic& h) { return torsional(h, reference::kSphere[0]); });
  const Eigen::MatrixXd pulsing = family([](const Harmonic& h) { return spheroidal(h, reference::kSphere[5]); });
  EXPECT_GT(subspace_mac(system, modes.shapes.middleCols(6, 5), twisting), 0.999);
  EXPECT_GT(subspace_mac(system, modes.shapes.middleCols(11, 5), pulsing), 0.999);
  EXPECT_LT(subspace_mac(system, modes.shapes.middleCols(11, 5), twisting), 0.001) << "the test cannot tell them apart";
}

}  // namespace
}  // namespace ringdown::exact_shapes_test
