#include "tests/support/synthetic_bank.h"

#include "engine/modal/levels/liquid_levels.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

namespace ringdown::test {
namespace {

constexpr double kPi = std::numbers::pi;

// beta L of the n-th flexural mode: the n-th positive root of cos x cosh x = 1, close to (2 n + 1) pi / 2.
double bar_wave_number(std::size_t n) {
  double x = (2 * static_cast<double>(n) + 1) * kPi / 2;
  for (int step = 0; step < 20; ++step) {  // Newton on cos x - 1 / cosh x
    const double sech = 1 / std::cosh(x);
    x -= (std::cos(x) - sech) / (-std::sin(x) + sech * std::tanh(x));
  }
  return x;
}

// Displacement at x in [0, 1], 2 or -2 at the ends; its mean square along the bar is 1. Symmetric about the middle for
// odd n, antisymmetric for even n.
double bar_shape(std::size_t n, double x) {
  const double k = bar_wave_number(n), y = k * (x - 0.5);
  if (n % 2 == 1) return std::cos(y) / std::cos(k / 2) + std::cosh(y) / std::cosh(k / 2);
  return std::sin(y) / std::sin(k / 2) + std::sinh(y) / std::sinh(k / 2);
}

void radiate_evenly(modal::Bank& bank) {
  bank.radiation.emplace();
  for (const double f : bank.frequency_hz) bank.radiation->maps.modes.push_back(even_field(f));
}

}  // namespace

modal::FarField even_field(double frequency_hz) {
  const auto value = static_cast<float>(modal::kUnknownFlow * std::sqrt(4 * kPi));
  const modal::Air air;
  return {.wavenumber_rad_m = static_cast<float>(modal::hz_to_rad_per_s(frequency_hz) / air.sound_speed_m_s),
          .terms = {{0, {value, 0}}},
          .unit = value};
}

modal::Bank single_mode_bank(double frequency_hz, double decay_per_s, modal::Vec3f shape) {
  modal::Bank bank{.name = "single"};
  bank.frequency_hz = {frequency_hz};
  bank.decay_per_s = {decay_per_s};
  const float s = static_cast<float>(1 / std::sqrt(3.0));
  bank.positions = {{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}};
  bank.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  bank.shapes.assign(4, shape);
  radiate_evenly(bank);
  return bank;
}

modal::Bank leveled_bank(double frequency_hz, double decay_per_s) {
  modal::Bank bank = single_mode_bank(frequency_hz, decay_per_s);
  bank.held = true;
  bank.provenance.liquids = {{.liquid = "water", .level_m = 0}};
  modal::LiquidLevels levels;
  for (const double x : {0.0, 0.01, 0.03, 0.06, 0.08, 0.1}) {
    levels.level_m.push_back(x);
    levels.volume_m3.push_back(0.01 * x);
    levels.added.push_back(static_cast<float>(kMassPerSquare * x * x));
    levels.drag.push_back(static_cast<float>(kDrag * x));
  }
  levels.mass = {1};
  levels.stiffness = {static_cast<float>(modal::undamped_lambda({frequency_hz, decay_per_s}))};
  bank.levels = std::make_shared<const modal::LiquidLevels>(std::move(levels));
  return bank;
}

modal::Bank vessel_bank() {
  modal::Bank bank = single_mode_bank(1000, 3);
  bank.frequency_hz.push_back(kAir_hz);
  bank.decay_per_s.push_back(kAirDecay_per_s);
  bank.shapes.resize(8);
  bank.radiation->maps.modes.push_back(even_field(kAir_hz));
  bank.cavity = modal::Cavity{.mouth_m = {0, 0, 1}, .diameter_m = kMouth_m, .modes = {{1, kFlux}}};
  return bank;
}

modal::Bank tubed_bank(const TwoOscillators& of) {
  using Complex = std::complex<double>;
  const Complex bar(modal::hz_to_rad_per_s(of.bar_hz), -of.bar_decay_per_s);
  const Complex tube(modal::hz_to_rad_per_s(of.tube_hz), -of.tube_decay_per_s);
  // The eigenvectors are (cos, sin) and (-sin, cos) of a complex angle.
  const Complex angle = 0.5 * std::atan(2.0 * of.pull_rad_s / (bar - tube));
  const Complex c = std::cos(angle), s = std::sin(angle);
  const Complex first = bar * c * c + tube * s * s + 2.0 * of.pull_rad_s * s * c, second = bar + tube - first;
  modal::Bank bank = single_mode_bank(1000, 3);
  bank.name = "tubed";
  bank.frequency_hz = {modal::rad_per_s_to_hz(first.real()), modal::rad_per_s_to_hz(second.real()), 1000};
  bank.decay_per_s = {-first.imag(), -second.imag(), 3};
  bank.shapes.clear();
  for (const double z : {kBarShape * std::abs(c), -kBarShape * std::abs(s)})
    bank.shapes.insert(bank.shapes.end(), 4, {0, 0, static_cast<float>(z)});
  bank.shapes.insert(bank.shapes.end(), 4, {0.5F, 0, 0});
  bank.radiation->maps.modes.clear();
  const auto field = [](double hz, Complex of_bar, Complex of_tube) {
    modal::FarField heard = even_field(hz);
    const auto one = static_cast<double>(heard.terms[0].value.real());
    heard.unit = 0;
    heard.terms = {{0, std::complex<float>(one * of_tube)}, {2, std::complex<float>(one * kBarSound * of_bar)}};
    return heard;
  };
  const Complex turn = c / std::abs(c), back = std::abs(c) / c;
  bank.radiation->maps.modes = {field(bank.frequency_hz[0], turn * c, turn * s),
                                field(bank.frequency_hz[1], -s * back, c * back), even_field(1000)};
  bank.provenance.resonators = {{.diameter_m = 1e-4,  // so thin that its mouth radiates next to nothing
                                 .length_m = 0.37,
                                 .frequency_hz = of.tube_hz,
                                 .decay_per_s = of.tube_decay_per_s,
                                 .end_correction_m = 0.01}};
  return bank;
}

modal::Bank bar_bank(std::size_t modes) {
  constexpr double kLength = 0.3, kWidth = 0.02, kThickness = 0.005;
  const modal::Material steel{"steel", 200e9, 0.3, 7800, {2.0, 5e-8}};
  const double mass = kLength * kWidth * kThickness * steel.density_kg_m3;
  const double stiffness = steel.youngs_modulus_pa * kWidth * std::pow(kThickness, 3) / 12;
  modal::Bank bank{.name = "bar", .material = steel};
  constexpr std::size_t kPoints = 17;
  for (std::size_t p = 0; p < kPoints; ++p) {
    bank.positions.push_back({static_cast<float>(kLength * static_cast<double>(p) / (kPoints - 1)), 0, 0});
  }
  for (std::size_t n = 1; n <= modes; ++n) {
    const double lambda = std::pow(bar_wave_number(n), 4) * stiffness / (mass * std::pow(kLength, 3));
    const double decay = 0.5 * (steel.damping.alpha_per_s + steel.damping.beta_s * lambda);
    bank.frequency_hz.push_back(std::sqrt(lambda - decay * decay) / (2 * kPi));
    bank.decay_per_s.push_back(decay);
    for (std::size_t p = 0; p < kPoints; ++p) {
      const double x = static_cast<double>(p) / (kPoints - 1);
      bank.shapes.push_back({0, 0, static_cast<float>(bar_shape(n, x) / std::sqrt(mass))});
    }
  }
  const auto moment = [mass](double a, double b) { return mass * (a * a + b * b) / 12; };
  bank.mass = modal::MassProperties{
      .mass_kg = mass,
      .center_of_mass_m = {kLength / 2, 0, 0},
      .inertia_kg_m2 = {moment(kWidth, kThickness), moment(kLength, kThickness), moment(kLength, kWidth)}};
  bank.provenance = {.generator = "tests",
                     .element = "Euler-Bernoulli",
                     .unknowns = 0,
                     .rigid_modes = 6,
                     .counted_modes = 23,
                     .band_low_hz = 20,
                     .band_high_hz = 20000,
                     .largest_residual = 1.25e-13,
                     .dropped_modes = 7,
                     .floor_db = 62.5,
                     .loss_db = -41.300000000000004};
  radiate_evenly(bank);
  return bank;
}

modal::Bank random_bank(std::uint32_t seed, std::size_t modes, std::size_t points) {
  std::mt19937 random(seed);
  const auto uniform = [&random](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  modal::Bank bank{.name = "random"};
  const std::size_t around = std::max<std::size_t>(3, static_cast<std::size_t>(std::sqrt(points)));
  const std::size_t rings = std::max<std::size_t>(1, (points + around - 1) / around);
  const auto point = [&](double polar, double azimuth) {
    const double radius = uniform(0.08, 0.12);
    bank.positions.push_back({static_cast<float>(radius * std::sin(polar) * std::cos(azimuth)),
                              static_cast<float>(radius * std::sin(polar) * std::sin(azimuth)),
                              static_cast<float>(radius * std::cos(polar))});
    return static_cast<std::uint32_t>(bank.positions.size() - 1);
  };
  const std::uint32_t top = point(0, 0), bottom = point(kPi, 0);
  const auto at = [&](std::size_t ring, std::size_t i) {
    return static_cast<std::uint32_t>(2 + ring * around + i % around);
  };
  for (std::size_t ring = 0; ring < rings; ++ring) {
    for (std::size_t i = 0; i < around; ++i) {
      point(kPi * (static_cast<double>(ring) + 1) / (static_cast<double>(rings) + 1),
            2 * kPi * static_cast<double>(i) / static_cast<double>(around));
    }
  }
  for (std::size_t i = 0; i < around; ++i) {
    bank.triangles.push_back({top, at(0, i), at(0, i + 1)});
    for (std::size_t ring = 0; ring + 1 < rings; ++ring) {
      bank.triangles.push_back({at(ring, i), at(ring + 1, i), at(ring + 1, i + 1)});
      bank.triangles.push_back({at(ring, i), at(ring + 1, i + 1), at(ring, i + 1)});
    }
    bank.triangles.push_back({bottom, at(rings - 1, i + 1), at(rings - 1, i)});
  }
  for (std::size_t m = 0; m < modes; ++m) {
    bank.frequency_hz.push_back(40 * std::pow(19000.0 / 40, uniform(0, 1)));
    bank.decay_per_s.push_back(std::log(1000.0) / (0.05 * std::pow(100.0, uniform(0, 1))));
  }
  for (std::size_t i = 0; i < modes * bank.positions.size(); ++i) {
    bank.shapes.push_back(
        {static_cast<float>(uniform(-1, 1)), static_cast<float>(uniform(-1, 1)), static_cast<float>(uniform(-1, 1))});
  }
  radiate_evenly(bank);
  return bank;
}

}  // namespace ringdown::test
