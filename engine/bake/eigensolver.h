// The modes of a free elastic body: K phi = lambda M phi, all of them up to a highest lambda. [worker]
//
// Today: Spectra's shift-invert Lanczos over CHOLMOD's supernodal Cholesky factors. K is singular (a free
// body has six rigid motions), so the shift is a small negative one, scaled to the problem: sigma =
// -highest_lambda / 10^4. How many modes there are is not known before; the request grows until one past the
// top is found. Another solver may take its place behind this header.
#pragma once

#include "engine/base/result.h"
#include "engine/fem/assembly.h"

#include <Eigen/Core>

#include <functional>
#include <string_view>

namespace ringdown::bake {

// Called now and then with what is being done and how far that is, 0..1. Return false to stop: the work in
// progress then fails with kCancelled. Not called during a factorisation, which may take tens of seconds.
using Progress = std::function<bool(std::string_view stage, double fraction)>;
inline constexpr std::string_view kCancelled = "cancelled";

struct EigenRequest {
  double highest_lambda = 0; // [rad^2/s^2], > 0
  int most_modes = 4096;     // more than these fail, instead of filling the memory
  double tolerance = 1e-9;   // relative, on 1 / (lambda - sigma)
};

struct Eigenmodes {
  Eigen::VectorXd lambda;    // m, ascending; the rigid motions' are zero to rounding, and may be below zero
  Eigen::MatrixXd shapes;    // 3N x m, phi_i^T M phi_j = delta_ij [kg^-1/2]
  Eigen::VectorXd residuals; // m, |K phi - lambda M phi| / |lambda M phi|; 0 for the rigid motions
  int rigid = 0;             // how many of the first modes are rigid motions
  int solves = 0;            // systems solved with the factors
  double factor_seconds = 0, iterate_seconds = 0;
};

// Fails when K - sigma M has no Cholesky factors (a mesh or material that is not sound), when the iteration
// does not converge, when there are more than most_modes, or when cancelled. Results repeat bit for bit on
// one machine.
Result<Eigenmodes> solve_modes(const fem::System& system, const EigenRequest& request,
                               const Progress& progress = {});

} // namespace ringdown::bake
