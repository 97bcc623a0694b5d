#include "engine/tube/line.h"

#include <cmath>
#include <numbers>

namespace ringdown::tube {
namespace {

using Complex = std::complex<double>;

constexpr double kViscosity_pa_s = 1.813e-5, kPrandtl = 0.71;  // of air at 20 degrees

// A velocity of 1 out of the mouth causes this mean pressure in it from inside, times -1.
Complex inside(const Line& line, const modal::Air& air, Complex omega) {
  const Complex i(0, 1), k = omega / air.sound_speed_m_s;
  const Complex layer = std::sqrt(2 * kViscosity_pa_s / (air.density_kg_m3 * omega)) * (1.0 + i) / line.radius_m;
  const Complex slow = 1.0 - layer, soft = 1.0 + (kHeatRatio - 1) / std::sqrt(kPrandtl) * layer;
  const Complex own = k * std::sqrt(soft / slow), turn = own * line.length_m;
  const Complex cosine = std::cos(turn), sine = std::sin(turn);
  if (line.stopped) return cosine / sine / (slow * own);
  // The far end has its own end correction and radiates as a simple source.
  const double a = line.radius_m;
  const Complex far = slow * own * (-kFreeEnd * a - i * k * a * a / 4.0);
  return (far * cosine - sine) / (far * sine + cosine) / (slow * own);
}

}  // namespace

WallLayers wall_layers(const modal::Air& air, double omega_rad_s) {
  const double viscous_m = std::sqrt(2 * kViscosity_pa_s / (air.density_kg_m3 * omega_rad_s));
  return {viscous_m, viscous_m / std::sqrt(kPrandtl)};
}

Complex mouth_impedance(const Line& line, const Outside& outside, const modal::Air& air, Complex omega_rad_s) {
  const Complex k = omega_rad_s / air.sound_speed_m_s;
  const Complex end =
      outside.end_m.real() + Complex(0, outside.end_m.imag()) * (k / std::max(outside.wavenumber_rad_m, 1e-300));
  return end + inside(line, air, omega_rad_s);
}

std::optional<TubeMode> tube_mode(const Line& line, const Outside& outside, const modal::Air& air, double guess_rad_s) {
  constexpr double kStep = 1e-5, kExact = 1e-13, kReach = 0.3;
  const auto impedance = [&](Complex omega) { return mouth_impedance(line, outside, air, omega); };
  const auto slope = [&](Complex omega) {
    const Complex step = kStep * omega;
    return (impedance(omega + step) - impedance(omega - step)) / (2.0 * step);
  };
  Complex omega = guess_rad_s;
  for (int i = 0; i < 50; ++i) {
    const Complex change = impedance(omega) / slope(omega);
    omega -= change;
    if (!(std::abs(omega - guess_rad_s) < kReach * guess_rad_s)) return std::nullopt;
    if (std::abs(change) < kExact * std::abs(omega)) return TubeMode{omega, -omega * slope(omega)};
  }
  return std::nullopt;
}

double partial_rad_s(const Line& line, double end_correction_m, const modal::Air& air, int n) {
  const double ends = line.stopped ? end_correction_m : end_correction_m + kFreeEnd * line.radius_m;
  const double quarters = line.stopped ? 2 * n + 1 : 2 * n + 2;
  return quarters * std::numbers::pi * air.sound_speed_m_s / (2 * (line.length_m + ends));
}

std::optional<double> length_for(Line line, const Outside& outside, const modal::Air& air, int n, double omega_rad_s) {
  constexpr double kExact = 1e-12;
  const double end = -outside.end_m.real();
  line.length_m = 0;
  const double ends = end + (line.stopped ? 0 : kFreeEnd * line.radius_m);
  line.length_m = partial_rad_s(line, end, air, n) / omega_rad_s * ends - ends;
  for (int i = 0; i < 50; ++i) {
    if (!(line.length_m > line.radius_m)) return std::nullopt;
    const auto mode = tube_mode(line, outside, air, omega_rad_s);
    if (!mode) return std::nullopt;
    const double off = mode->omega_rad_s.real() / omega_rad_s - 1;
    line.length_m += off * (line.length_m + ends);
    if (std::abs(off) < kExact) return line.length_m;
  }
  return std::nullopt;
}

}  // namespace ringdown::tube
