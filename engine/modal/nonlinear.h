// The geometric nonlinearity of a bank's lowest modes, which makes a thin object's pitch depend on how hard it is
// struck.
//
// With q the modal displacements [kg^1/2 m], the energy of M modes is
//
//   E = 1/2 q^T Omega^2 q + sum over k of [ (g_k . q) t_k + 1/2 t_k^2 ],     t_k = q^T H^k q
//
// with K functions k (docs/how/nonlinear.md). g is zero in flat objects. [any thread, unless stated otherwise]
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ringdown::modal {

inline constexpr std::size_t kMaxNonlinearModes = 300, kMaxNonlinearFunctions = 100, kMaxCoupled = 300;

struct NonlinearTerms {
  std::vector<std::uint32_t> modes;  // M different numbers of modes in the bank
  std::vector<float> bending;        // K x M (M + 1) / 2: H^k_ij, i >= j, row after row  [kg^-1/2 m^-1 s^-1]
  std::vector<float> curving;        // K x M: g                                          [s^-1]
  double thickness_m = 0;            // thickness of the body, > 0
  double residual = 0;               // share of the modes' energy that K functions miss; 0 to 1
  std::uint32_t coupled = 0;         // number of lowest modes that exchange energy while loud; 0 to kMaxCoupled
  std::vector<double> errors;        // M estimated relative errors of a mode's own hardening, or empty

  [[nodiscard]] std::size_t mode_count() const { return modes.size(); }
  [[nodiscard]] std::size_t pairs() const { return modes.size() * (modes.size() + 1) / 2; }
  [[nodiscard]] std::size_t function_count() const { return modes.empty() ? 0 : curving.size() / modes.size(); }
  [[nodiscard]] float h(std::size_t k, std::size_t i, std::size_t j) const {
    return bending[k * pairs() + (i < j ? j * (j + 1) / 2 + i : i * (i + 1) / 2 + j)];
  }
  [[nodiscard]] float g(std::size_t k, std::size_t i) const { return curving[k * modes.size() + i]; }
};

// Multiplies H by `bending` and g by `curving`, for an object in another material and size (rescale() in
// material_scale.h).
void multiply(NonlinearTerms& terms, double bending, double curving);

// Keeps only the modes whose numbers in the bank are in `order` and renumbers them 0, 1, ... (mode_choice.h).
void take_modes(NonlinearTerms& terms, const std::vector<std::size_t>& order);

// How the modes detune each other, to second order in their amplitudes: mode m turns faster by
//
//   delta omega_m = sum over l of  B_ml A_l^2                               [rad/s, A in kg^1/2 m]
//
// The quartic part gives B_ml = (a + 2 b)_lm / (2 omega_m), and 3/4 a_mm / omega_m for a mode by itself, with
// a_lm = sum over k of H_ll H_mm, b_lm = sum H_lm^2. The cubic part (curved objects) contributes through pairs of its
// forces: a static offset, and motions at sums and differences of two frequencies, whose denominators are bounded near
// resonance (Nayfeh & Mook, Nonlinear Oscillations, 1979, chapter 6: averaging).
// `omega_rad_s` has M numbers. Returns M x M numbers, row by row. [worker]
std::vector<double> detuning(const NonlinearTerms& terms, const std::vector<double>& omega_rad_s);

}  // namespace ringdown::modal
