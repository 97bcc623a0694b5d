#include "engine/materials/material_bar.h"

#include <array>
#include <cmath>
#include <numbers>

// A Timoshenko beam with free ends
//
// The equations (Beam) have solutions of two parts, hyperbolic and circular in x, whose wave numbers p and q follow
// from the frequency (Wave). About the middle a mode is even or odd, so that either parity has one free ratio, and the
// two conditions at an end, no moment and no shear force, leave one equation in the frequency: Wave::at_ends().
// bar_lambdas() steps upward in a scale in which the roots of a thin bar lie pi / 2 apart, and bisects where the sign
// changes. It stays below the cut-off frequency, above which the hyperbolic part becomes circular, too. The shear
// coefficient is Cowper's for a rectangle, 10 (1 + nu) / (12 + 11 nu) (J. Appl. Mech. 33, 1966).
namespace ringdown::bake {
namespace {

constexpr double kMaxFrequency_hz = 20000, kBelowCutOff = 0.8;

// The bar as a line. Motion w across it and the sections' angle psi obey
//   E I psi'' + kappa A G (w' - psi) + rho I omega^2 psi = 0,   kappa A G (w'' - psi') + rho A omega^2 w = 0.
struct Beam {
  Beam(const modal::Material& material, const Bar& bar)
      : length_m(bar.length_m),
        area_m2(bar.width_m * bar.thickness_m),
        inertia_m4(bar.width_m * std::pow(bar.thickness_m, 3) / 12),
        youngs_modulus_pa(material.youngs_modulus_pa),
        density_kg_m3(material.density_kg_m3) {
    const double nu = material.poisson_ratio;
    shear_pa = 10 * (1 + nu) / (12 + 11 * nu) * youngs_modulus_pa / (2 * (1 + nu));
  }
  double length_m, area_m2, inertia_m4, youngs_modulus_pa, density_kg_m3;
  double shear_pa = 0;  // kappa G
};

enum class Parity { even, odd };

// Between sections, a mode is A cosh(p x) + B cos(q x), or sinh and sin, from the bar's middle.
struct Wave {
  Wave(const Beam& beam, double lambda) {
    const double rotary = beam.density_kg_m3 * lambda / beam.youngs_modulus_pa;
    const double mass = rotary * beam.area_m2 / beam.inertia_m4;
    shear = beam.density_kg_m3 * lambda / beam.shear_pa;
    const double root = std::hypot((rotary - shear) / 2, std::sqrt(mass));
    p = std::sqrt(root - (rotary + shear) / 2);
    q = std::sqrt(root + (rotary + shear) / 2);
  }
  double p = 0, q = 0;
  double shear = 0;  // rho lambda / (kappa G)

  // Zero where neither moment nor shear force is left at the ends.
  [[nodiscard]] double at_ends(double half_m, Parity parity) const {
    const double slow = (p * p + shear) / q, fast = (q * q - shear) / p, tanh = std::tanh(p * half_m);
    if (parity == Parity::even) return slow * std::sin(q * half_m) + fast * tanh * std::cos(q * half_m);
    return slow * tanh * std::cos(q * half_m) - fast * std::sin(q * half_m);
  }
};

double bisect(const Beam& beam, Parity parity, double low, double high) {
  const auto at = [&](double lambda) { return Wave(beam, lambda).at_ends(beam.length_m / 2, parity); };
  const bool rising = at(low) < 0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    ((at(middle) < 0) == rising ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// Displacement of the upper face in a mode, not normalised, and the mass that it moves.
struct Shape {
  Shape(const Beam& beam, double lambda, Parity whose) : wave(beam, lambda), parity(whose) {
    const double half = beam.length_m / 2;
    // No shear force at the ends: A times the hyperbolic part, scaled to 1 at the end, and B times the other.
    hyperbolic_end = parity == Parity::even ? std::cosh(wave.p * half) : std::sinh(wave.p * half);
    const double ratio = parity == Parity::even ? std::tanh(wave.p * half) : 1 / std::tanh(wave.p * half);
    const double circular = parity == Parity::even ? std::sin(wave.q * half) : -std::cos(wave.q * half);
    amplitude = -ratio * wave.q / (wave.p * circular);
  }
  [[nodiscard]] double across(double x) const {
    const double hyperbolic = parity == Parity::even ? std::cosh(wave.p * x) : std::sinh(wave.p * x);
    const double circular = parity == Parity::even ? std::cos(wave.q * x) : std::sin(wave.q * x);
    return hyperbolic / hyperbolic_end + amplitude * circular;
  }
  [[nodiscard]] double angle(double x) const {
    const double a = wave.p + wave.shear / wave.p, c = wave.shear / wave.q - wave.q;
    const double hyperbolic = parity == Parity::even ? std::sinh(wave.p * x) : std::cosh(wave.p * x);
    const double circular = parity == Parity::even ? std::sin(wave.q * x) : -std::cos(wave.q * x);
    return a * hyperbolic / hyperbolic_end + amplitude * c * circular;
  }
  Wave wave;
  Parity parity;
  double hyperbolic_end = 1, amplitude = 0;
};

double modal_mass(const Beam& beam, const Shape& shape) {
  constexpr int kIntervals = 4000;
  const double step = beam.length_m / kIntervals;
  double sum = 0;
  for (int i = 0; i <= kIntervals; ++i) {
    const double x = i * step - beam.length_m / 2, w = shape.across(x), psi = shape.angle(x);
    const double weight = i == 0 || i == kIntervals ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;  // Simpson's
    sum += weight * (beam.area_m2 * w * w + beam.inertia_m4 * psi * psi);
  }
  return beam.density_kg_m3 * sum * step / 3;
}

// The first relaxations of heat through a wall that bends, without Poisson's ratio: of the n-th, n odd, the strength is
// 96 / (pi n)^4 of the whole and the time (thickness / (pi n))^2 over the diffusivity (Zener, Phys. Rev. 52, 1937).
modal::ModeHeat heat_of_wall(const modal::Material& material, double thickness_m) {
  const double whole =
      modal::relaxation_strength(*material.thermal, material.youngs_modulus_pa, material.density_kg_m3);
  const double flow = modal::diffusivity(*material.thermal, material.density_kg_m3);
  modal::ModeHeat heat;
  for (std::size_t j = 0; j < heat.size(); ++j) {
    const double turns = std::numbers::pi * (2 * static_cast<double>(j) + 1);
    heat[j] = {96 / std::pow(turns, 4) * whole, thickness_m * thickness_m / (turns * turns * flow)};
  }
  return heat;
}

Parity parity_of(std::size_t mode) { return mode % 2 == 0 ? Parity::even : Parity::odd; }

}  // namespace

std::vector<double> bar_lambdas(const modal::Material& material, const Bar& bar, double highest_lambda) {
  const Beam beam(material, bar);
  const double cut_off = beam.shear_pa * beam.area_m2 / (beam.density_kg_m3 * beam.inertia_m4);
  const double top = std::min(highest_lambda, kBelowCutOff * kBelowCutOff * cut_off);
  const double unit = beam.youngs_modulus_pa * beam.inertia_m4 / (beam.density_kg_m3 * beam.area_m2);
  // Steps in half the wave number of a thin bar, whose roots are about pi / 2 apart.
  constexpr double kFirst = 1, kStep = 0.02;
  const auto lambda_at = [&](double half_waves) { return unit * std::pow(2 * half_waves / beam.length_m, 4); };
  std::vector<double> lambdas;
  std::array<double, 2> last = {0, 0};
  for (double at = kFirst; lambda_at(at - kStep) < top; at += kStep) {
    const Wave wave(beam, lambda_at(at));
    for (const Parity parity : {Parity::even, Parity::odd}) {
      const double now = wave.at_ends(beam.length_m / 2, parity);
      double& before = last[static_cast<std::size_t>(parity)];
      if (at > kFirst && (before < 0) != (now < 0)) {
        const double lambda = bisect(beam, parity, lambda_at(at - kStep), lambda_at(at));
        if (lambda <= top) lambdas.push_back(lambda);
      }
      before = now;
    }
  }
  return lambdas;
}

modal::Bank bar_bank(const modal::Material& material, const Bar& bar) {
  const Beam beam(material, bar);
  const double omega = modal::hz_to_rad_per_s(kMaxFrequency_hz);
  modal::Bank bank;
  bank.name = material.name;
  bank.material = material;
  const double half_height = bar.thickness_m / 2, step = bar.length_m / (kBarPoints - 1);
  for (int i = 0; i < kBarPoints; ++i) {
    bank.positions.push_back({static_cast<float>(i * step - bar.length_m / 2), 0, static_cast<float>(half_height)});
  }
  const std::vector<double> lambdas = bar_lambdas(material, bar, omega * omega);
  for (std::size_t m = 0; m < lambdas.size(); ++m) {
    modal::ModeLoss loss = modal::mode_loss(material.damping_law(), lambdas[m]);
    if (material.thermal) {
      bank.heat.push_back(heat_of_wall(material, bar.thickness_m));
      loss.heat_per_s = modal::heat_loss(bank.heat.back(), std::sqrt(lambdas[m]));
    }
    const modal::DampedMode mode = modal::with_decay(lambdas[m], loss.total_per_s());
    if (mode.frequency_hz <= 0) {
      if (material.thermal) bank.heat.pop_back();
      continue;
    }
    const Shape shape(beam, lambdas[m], parity_of(m));
    const double scale = 1 / std::sqrt(modal_mass(beam, shape));
    bank.frequency_hz.push_back(mode.frequency_hz);
    bank.decay_per_s.push_back(mode.decay_per_s);
    bank.losses.push_back(loss);
    for (int i = 0; i < kBarPoints; ++i) {
      const double x = i * step - bar.length_m / 2;
      bank.shapes.push_back(
          {static_cast<float>(-scale * half_height * shape.angle(x)), 0, static_cast<float>(scale * shape.across(x))});
    }
  }
  const double mass = beam.density_kg_m3 * beam.area_m2 * beam.length_m;
  const auto about = [&](double a, double b) { return mass * (a * a + b * b) / 12; };
  bank.mass =
      modal::MassProperties{.mass_kg = mass,
                            .inertia_kg_m2 = {about(bar.width_m, bar.thickness_m), about(bar.length_m, bar.thickness_m),
                                              about(bar.length_m, bar.width_m)}};
  return bank;
}

}  // namespace ringdown::bake
