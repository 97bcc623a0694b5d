// The modes of a free elastic body: K phi = lambda M phi, all of them up to a highest lambda. [worker]
//
//   Result<Eigenmodes> modes = solve_modes(system, {.highest_lambda = square(2 * pi * 20e3)});
//
// K is singular (a free body has six rigid motions for each piece), M is not. The number of modes below the top is
// counted, not guessed: by Sylvester's law of inertia, a symmetric factorisation K - lambda M = L D L^T has as many
// negative entries in D as there are eigenvalues below lambda. The set returned has exactly that many, or the solver
// fails and says so.
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/fem/assembly.h"

#include <Eigen/Core>

#include <string_view>

namespace ringdown::solve {

// All but kSlepc use our own L D L^T factorization, whose inertia counts the modes (docs/how/eigensolver.md).
enum class Method {
  kAutomatic,     // kDense, kSpectra or kBlockLanczos, by the number of unknowns and of counted modes
  kDense,         // Eigen on full matrices
  kSpectra,       // Spectra's shift-invert Lanczos, one vector at a time
  kBlockLanczos,  // shift-invert Lanczos in blocks, in slices of the spectrum
  kSlepc,         // SLEPc over MPI, in separate processes (engine/solve/distributed.h); only if built with it
};

// Names: "auto", "dense", "spectra", "block", "slepc".
std::string_view method_name(Method method);
Result<Method> parse_method(std::string_view name);

struct EigenRequest {
  double highest_lambda = 0;  // [rad^2/s^2], > 0
  int max_modes = 4096;       // solves with more modes fail, instead of filling the memory
  double tolerance = 1e-9;    // relative, on 1 / (lambda - sigma)
  Method method = Method::kAutomatic;
  int threads = 0;  // 0: one per processor
  // The elastic eigenvalues of a similar body, ascending; may be empty, or end before highest_lambda. Used for planning
  // only: they change how long a solve takes, not the result.
  Eigen::VectorXd expected_lambda = {};
  // The number of rigid motions, when the caller knows it (six for each piece); they are the first modes. -1: all modes
  // whose lambda is zero to rounding. In a mesh of very thin or distorted elements, rounding may be as large as a
  // vibration's lambda.
  int rigid = -1;
  int processes = 2;    // processes of kSlepc
  bool verify = false;  // true: another method finds the modes near two shifts; a disagreement fails
  double unit_hz = 1;   // a frequency of 1 in the units of K and M, in Hz; used in messages

  [[nodiscard]] double hertz(double lambda) const;
};

// The largest differences that a second opinion (EigenRequest::verify) found, all within the allowed limits.
struct Agreement {
  int modes = 0;         // modes compared; 0: no second opinion was asked for
  double frequency = 0;  // relative
  double angle = 0;      // between the spaces of close modes, sine
  double residual = 0;   // |K phi - lambda M phi| / |lambda M phi|, from K and M as they were given
  double seconds = 0;    // time that asking and comparing took
};

struct Eigenmodes {
  Eigen::VectorXd lambda;     // m, ascending; zero to rounding for rigid motions, where values may be negative
  Eigen::MatrixXd shapes;     // 3N x m, phi_i^T M phi_j = delta_ij [kg^-1/2]
  Eigen::VectorXd residuals;  // m, |K phi - lambda M phi| / |lambda M phi|; 0 for the rigid motions
  int rigid = 0;              // number of rigid motions, which are the first modes
  int counted = 0;            // eigenvalues below highest_lambda by inertia, rigid ones included: equal to m
  int solves = 0;             // right-hand sides solved for
  int factorizations = 0;
  double factor_seconds = 0, iterate_seconds = 0;  // wall time
  Method method = Method::kAutomatic;              // method that found the modes
  Agreement agreement;
};

// Finds the modes. Fails when the system cannot be factored (the mesh or material is unsound), when the iteration does
// not converge, when the numbers of found and counted modes differ, when the second opinion disagrees, when there are
// more than max_modes modes, or when cancelled. Results repeat bit for bit on one machine with one number of threads.
Result<Eigenmodes> solve_modes(const fem::System& system, const EigenRequest& request, const Progress& progress = {});

}  // namespace ringdown::solve
