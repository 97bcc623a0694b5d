// The air in a tube, as a line with losses at the wall. [any thread]
//
// The air in the tube moves as a plane wave, and the air in its mouth like a piston. Pressures are given as P = p / (i
// rho omega), so that dP/dn is a velocity; the time factor is exp(-i omega t). A velocity of 1 out of the mouth causes
// the mean pressure A (the end, in metres) in the mouth from outside. The tube rings where both sides agree:
//
//   Z(omega) = A + cot(k' L) / (s_v k') = 0       (stopped at the far end)
//
//   k' = k sqrt(s_t / s_v),   s_v = 1 - (1 + i) delta_v / a,   s_t = 1 + (gamma - 1) (1 + i) delta_t / a
//
// for boundary layers delta_v = sqrt(2 nu / omega) and delta_t = delta_v / sqrt(Pr) thin beside the radius a
// (Kirchhoff's wide tube). Near a zero, Z = L' (omega_t - omega) / omega_t, which makes the mode an oscillator.
#pragma once

#include "engine/modal/radiation_map.h"

#include <complex>
#include <optional>

namespace ringdown::tube {

struct Line {
  double radius_m = 0, length_m = 0;
  bool stopped = true;  // false: open at the far end, too
};

// The air outside of the mouth at one wavenumber. The real part of `end_m` is minus the end correction; the imaginary
// part is the loss by radiation, and grows with the wavenumber.
struct Outside {
  std::complex<double> end_m;
  double wavenumber_rad_m = 0;
};

// A mode of the air in a tube.
struct TubeMode {
  std::complex<double> omega_rad_s;  // the imaginary part is minus the decay [1/s]
  std::complex<double> reach_m;      // L': about the length of a stopped tube with its end correction
};

// Z at a complex frequency [m].
std::complex<double> mouth_impedance(const Line& line, const Outside& outside, const modal::Air& air,
                                     std::complex<double> omega_rad_s);

// The zero of Z next to a guess; nothing if the iteration does not end there.
std::optional<TubeMode> tube_mode(const Line& line, const Outside& outside, const modal::Air& air, double guess_rad_s);

// The frequency of partial `n` = 0, 1, ... by the lengths alone: (2 n + 1) c / (4 L') stopped, (n + 1) c / (2 L') open.
double partial_rad_s(const Line& line, double end_correction_m, const modal::Air& air, int n);

// The length at which partial `n` of the tube rings at a frequency; nothing if the tube would be shorter than its
// radius.
std::optional<double> length_for(Line line, const Outside& outside, const modal::Air& air, int n, double omega_rad_s);

// Thickness of the layers of friction and of heat at a wall [m], in air of 20 degrees.
struct WallLayers {
  double viscous_m = 0, thermal_m = 0;
};
WallLayers wall_layers(const modal::Air& air, double omega_rad_s);
inline constexpr double kHeatRatio = 1.4;  // gamma of air

// The end correction of a thin-walled open end in free air, over the radius, for waves that are long beside it: Levine
// & Schwinger, Phys. Rev. 73 (1948) 383.
inline constexpr double kFreeEnd = 0.6133;

}  // namespace ringdown::tube
