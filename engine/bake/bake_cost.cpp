#include "engine/bake/bake_cost.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <numbers>

// Models of time and memory
//
// By unknown: assembling K and M, the estimate of errors and the sample points take a time that does not depend on the
// body; the longer modes take, the more of them there are. K and what is made of it take kBytes.
//
// By entry of the factors of K: e for each unknown. In thin bodies nested dissection leaves e nearly constant, in
// solids it grows with their size (George, SIAM J. Numer. Anal. 10, 1973), here as the root of the unknowns. A
// factorization takes about 3 e^2 operations for each unknown, and block Lanczos factors once at the top and once for
// each slice of the spectrum.
//
// Below its ring frequency a tube's wall bends only where it also stretches, so that its modes are fewer than those of
// a flat plate, about as the root of the frequency (Szechenyi, J. Sound Vib. 19, 1971).
//
// By mode: its shape and the vectors of block Lanczos, about three numbers for each unknown.
//
// The constants were fitted to bakes of presets and scans (docs/how/accuracy.md).
namespace ringdown::bake {
namespace {

constexpr std::array kSeconds = {0.1e-3, 0.17e-3, 0.15e-3, 0.2e-3};  // by unknown, of order 1 to 4
constexpr std::array kBytes = {1.2e3, 2e3, 4.5e3, 7e3};
constexpr std::array kEntries = {160.0, 250.0, 400.0, 550.0};  // of a thin body, or a solid of kUnknowns
constexpr double kUnknowns = 50e3;
constexpr double kSecondsPerMode = 1.4e-6;  // by unknown
constexpr double kBytesPerMode = 24;        // by unknown
constexpr double kModesPerSlice = 150;
constexpr double kProcessor = 30e9;  // operations a second, where the constants were measured
constexpr double kProgramBytes = 25e6;
constexpr double kRigidModes = 6;
constexpr double kSlender = 3;   // times as long as wide, at least
constexpr double kRound = 0.7;   // of the bend that a round rod of the same 2 V / A has, at least
constexpr double kDoubt = 1.25;  // a bake is refused that seems to take so many times what is free

// Operations of a product of two matrices, per second of processor time.
double speed_of_processor() {
  constexpr Eigen::Index kSize = 512;
  const Eigen::MatrixXd a = Eigen::MatrixXd::Constant(kSize, kSize, 1e-3);
  Eigen::MatrixXd product(kSize, kSize);
  product.noalias() = a * a;
  const std::clock_t start = std::clock();
  product.noalias() = a * product;
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return 2.0 * kSize * kSize * kSize / std::max(seconds, 1e-3);
}

// Entries of the factors for each unknown. A body of nodes all about as far apart counts as a solid as far as it is as
// thick as a cube of its volume, whose 2 V / A is a third of its edge.
double entries_of(const BodyShape& shape, double unknowns, int order) {
  const double solid = std::min(1.0, 3 * shape.thickness_m / std::cbrt(shape.volume_m3));
  return kEntries[order - 1] * std::pow(std::max(1.0, unknowns / kUnknowns), solid / 2);
}

BakeCost cost_of(const BodyShape& shape, double unknowns, int order, double modes) {
  static const double speed = speed_of_processor();
  const double entries = entries_of(shape, unknowns, order);
  const double by_unknown = (kSeconds[order - 1] + kSecondsPerMode * modes) * kProcessor / speed;
  const double factoring = 3 * entries * entries * (2 + modes / kModesPerSlice) / speed;
  return {.unknowns = unknowns,
          .modes = modes,
          .processor_s = unknowns * (by_unknown + factoring),
          .memory_bytes = kProgramBytes + unknowns * (kBytes[order - 1] + 8 * entries + kBytesPerMode * modes)};
}

struct Bar {
  double length_m, high_m, wide_m;  // of the box that bends as it does
};

// Rigid motions included: each wave along a free bar has one mode for each half of its length, and one more, which a
// bending wave's ends delay by another half (k L / pi = n + 1/2).
double modes_of(const Bar& bar, const modal::Material& material, double omega) {
  const double e = material.youngs_modulus_pa, nu = material.poisson_ratio, rho = material.density_kg_m3;
  const double stretch = omega * std::sqrt(rho / e), twist = omega * std::sqrt(2 * (1 + nu) * rho / e);
  double modes = (stretch + twist) * bar.length_m / std::numbers::pi + 2;
  for (const double high : {bar.high_m, bar.wide_m}) {
    modes += std::sqrt(stretch * std::sqrt(12.0) / high) * bar.length_m / std::numbers::pi + 1.5;
  }
  return modes;
}

// Returns the modes of a bar of the body's size, where the body is like one: straight and slender, or a rod that may be
// bent, whose surface curves as a round rod's does. Returns 0 elsewhere.
double modes_of_bar(const BodyShape& shape, const modal::Material& material, double omega) {
  double modes = 0;
  if (shape.length_m > kSlender * shape.width_m) {
    const double high = shape.volume_m3 / (shape.length_m * shape.width_m);
    modes = modes_of({shape.length_m, high, shape.width_m}, material, omega);
  }
  const double radius = shape.thickness_m;  // 2 V / A
  if (shape.bend_per_m * radius > kRound) {
    const double length = shape.volume_m3 / (std::numbers::pi * radius * radius), high = std::sqrt(3.0) * radius;
    modes = std::max(modes, modes_of({length, high, high}, material, omega));
  }
  return modes;
}

}  // namespace

double expected_modes(const BodyShape& shape, const modal::Material& material, double frequency_hz) {
  const double e = material.youngs_modulus_pa, nu = material.poisson_ratio, rho = material.density_kg_m3;
  const double omega = modal::hz_to_rad_per_s(frequency_hz), pi = std::numbers::pi;
  const double lambda = modal::highest_lambda_in_band(frequency_hz, material.damping);
  const double area = shape.volume_m3 / shape.thickness_m, h = shape.thickness_m;  // of one side
  const double bending = std::sqrt(12 * (1 - nu * nu) * rho / e) / h;              // sqrt(rho h / D)
  const double shear_2 = e / (2 * (1 + nu) * rho), stretch_2 = e / ((1 - nu * nu) * rho);
  const double once_around = shape.bend_per_m * std::sqrt(stretch_2);  // a tube's ring frequency [rad/s]
  const double unbent = std::sqrt(omega / (omega + once_around));
  const double plate = area / (4 * pi) * (omega * bending * unbent + omega * omega * (1 / shear_2 + 1 / stretch_2));
  const double all = debye_count(shape.volume_m3, material, lambda) + plate;
  return std::max(1.0, std::max(all, modes_of_bar(shape, material, omega)) - kRigidModes);
}

BakeCost expected_cost(const mesh::TetMesh& mesh, fem::Element element, const modal::Material& material,
                       double band_high_hz) {
  const int order = fem::order_of(element);
  const mesh::TetMesh raised = mesh.order() == order ? mesh::TetMesh() : mesh::to_order(mesh, order);
  const auto nodes = static_cast<double>((mesh.order() == order ? mesh : raised).nodes.rows());
  const BodyShape shape = measure_shape(mesh);
  return cost_of(shape, 3 * nodes, order, expected_modes(shape, material, band_high_hz));
}

BakeCost expected_cost(const BodyShape& shape, double size_m, fem::Element element, const modal::Material& material,
                       double band_high_hz) {
  const int order = fem::order_of(element);
  return cost_of(shape, estimated_unknowns(shape, size_m, order), order, expected_modes(shape, material, band_high_hz));
}

Result<void> check_memory(const BakeCost& cost, double free_bytes, const std::string& name) {
  if (cost.memory_bytes <= kDoubt * free_bytes) return {};
  const std::string text = formatted(
      ": not enough memory: {:.2g} unknowns and about {:.2g} modes take about {:.2g} GiB, and {:.2g} are free; choose "
      "a coarser --mesh-size (one {:.2g} times as large), a lower --element, or a narrower --band",
      cost.unknowns, cost.modes, cost.memory_bytes / 1073741824, free_bytes / 1073741824,
      std::pow(cost.memory_bytes / std::max(free_bytes, 1.0), 0.3));
  return fail(ErrorKind::no_memory, name + text);
}

}  // namespace ringdown::bake
