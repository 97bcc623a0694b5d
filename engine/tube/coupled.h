// The modes of a bar and of tubes under it together. [any thread]
//
// Bar modes q_i and tube modes v_t, each of mass 1, pull each other (docs/how/tubes.md):
//
//   (omega_i - omega) q_i + sum over t of g_it v_t = f_i,       g_it = B_i sqrt(rho S omega_i omega_t / (2 L'_t))
//   (omega_t - omega) v_t + sum over i of g_it q_i = 0
//
// with complex omega_i and omega_t, whose imaginary parts are minus the decays. The matrix is complex and symmetric, so
// its eigenvectors x satisfy x^T x = 1, not x^H x = 1. Where two modes become one (an exceptional point) no such
// vectors exist; the first tube is then detuned by half a cent.
#pragma once

#include <Eigen/Core>

namespace ringdown::tube {

struct Oscillators {
  Eigen::VectorXcd bar, tube;  // N and T complex angular frequencies [rad/s]
  Eigen::MatrixXcd bond;       // N x T [rad/s]
};

struct CoupledModes {
  Eigen::VectorXcd omega_rad_s;  // N + T: mode n is nearest to oscillator n, bar modes first
  Eigen::MatrixXcd mixing;       // (N + T) x (N + T): the columns are x, with x^T x = 1 and a real part >= 0 of x_nn
  bool detuned = false;          // true: the tubes were detuned to avoid an exceptional point
};

CoupledModes coupled_modes(const Oscillators& oscillators);

}  // namespace ringdown::tube
