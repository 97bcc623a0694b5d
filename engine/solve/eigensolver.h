// The modes of a free elastic body: K phi = lambda M phi, all of them up to a highest lambda. [worker]
//
//   Result<Eigenmodes> modes = solve_modes(system, {.highest_lambda = square(2 * pi * 20e3)});
//
// K is singular (a free body has six rigid motions for each piece), M is not. How many modes lie below the top is
// counted, not guessed: by Sylvester's law of inertia a symmetric factorisation K - lambda M = L D L^T has as many
// negative entries in D as there are eigenvalues below lambda. The set returned has exactly that many, or the solver
// fails and says so.
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/fem/assembly.h"

#include <Eigen/Core>

#include <string_view>

namespace ringdown::solve {

// All but kSlepc work on one L D L^T of our own, whose inertia counts the modes (docs/how/eigensolver.md).
enum class Method {
  kAutomatic,     // by the number of unknowns and of modes counted: kDense, kSpectra or kBlockLanczos
  kDense,         // Eigen on full matrices
  kSpectra,       // Spectra's shift-invert Lanczos, one vector at a time
  kBlockLanczos,  // shift-invert Lanczos in blocks, in slices of the spectrum
  kSlepc,         // SLEPc over MPI, in processes of their own (engine/solve/distributed.h); only where it was built
};

// "auto", "dense", "spectra", "block", "slepc".
std::string_view method_name(Method method);
Result<Method> parse_method(std::string_view name);

struct EigenRequest {
  double highest_lambda = 0;  // [rad^2/s^2], > 0
  int max_modes = 4096;       // more than these fail, instead of filling the memory
  double tolerance = 1e-9;    // relative, on 1 / (lambda - sigma)
  Method method = Method::kAutomatic;
  int threads = 0;  // 0: as many as there are processors
  // Where a near relative of the body had its elastic modes, ascending; may be empty, or end before highest_lambda. For
  // planning only: it changes how long a solve takes, not what is found.
  Eigen::VectorXd expected_lambda = {};
  // How many motions of the body are rigid, when the caller knows (six for each piece): the first ones. -1: those whose
  // lambda is zero to rounding; in a mesh of very thin or distorted elements that may be as much as a vibration's.
  int rigid = -1;
  int processes = 2;    // of kSlepc
  bool verify = false;  // asks another method for the modes near two shifts, and fails when the two disagree
  double unit_hz = 1;   // a frequency of 1 in the units of K and M, in Hz: for sentences about modes

  [[nodiscard]] double hertz(double lambda) const;
};

// An Agreement holds the largest differences that a second opinion (EigenRequest::verify) found, all within what is
// allowed.
struct Agreement {
  int modes = 0;         // compared; 0: no second opinion was asked for
  double frequency = 0;  // relative
  double angle = 0;      // between the spaces of close modes, sine
  double residual = 0;   // |K phi - lambda M phi| / |lambda M phi|, from K and M as they were given
  double seconds = 0;    // that asking and comparing took
};

struct Eigenmodes {
  Eigen::VectorXd lambda;     // m, ascending; the rigid motions' are zero to rounding, and may be below zero
  Eigen::MatrixXd shapes;     // 3N x m, phi_i^T M phi_j = delta_ij [kg^-1/2]
  Eigen::VectorXd residuals;  // m, |K phi - lambda M phi| / |lambda M phi|; 0 for the rigid motions
  int rigid = 0;              // how many of the first modes are rigid motions
  int counted = 0;            // eigenvalues below highest_lambda by inertia, rigid ones included: equal to m
  int solves = 0;             // right-hand sides solved for
  int factorizations = 0;
  double factor_seconds = 0, iterate_seconds = 0;  // on the clock
  Method method = Method::kAutomatic;              // that found them
  Agreement agreement;
};

// Fails when the system cannot be factored (a mesh or material that is not sound), when the iteration does not
// converge, when modes found and counted disagree, when the second opinion disagrees, when there are more than
// max_modes, or when cancelled. Results
// repeat bit for bit on one machine with one number of threads.
Result<Eigenmodes> solve_modes(const fem::System& system, const EigenRequest& request, const Progress& progress = {});

}  // namespace ringdown::solve
