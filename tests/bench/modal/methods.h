// The solvers that the modal benchmark measures, each in the process that calls.
//
//   ours            solve_modes(), whatever it chooses
//   spectra         solve_modes() by Spectra over our own factors
//   block           solve_modes() by block Lanczos
//   spectra-cholmod Spectra over CHOLMOD, asked at once for as many modes as there are: nothing of it is ours
//   slepc-petsc     SLEPc's Krylov-Schur over PETSc's own Cholesky, one process, asked likewise
//   slepc-cholmod   the same over CHOLMOD
//   slepc-mumps     the same over MUMPS
//   ccx             CalculiX: C3D10, *FREQUENCY
//   ccx-mass        ours on the matrices that CalculiX makes of straight elements: what ccx must find
//   bake            ringdown-bake with its default settings: its own mesh and element
#pragma once

#include "tests/bench/modal/measurement.h"

namespace ringdown::bench {

// Whether the program that a method needs is there.
bool installed(const std::string& method);

// Writes the frequencies to `frequencies`, unless that is empty. `reference` are frequencies to compare with where the
// body has no exact ones; may be empty. Never fails: the status says what happened.
Measurement measure(const Spec& spec, double limit_s, const std::filesystem::path& frequencies,
                    const std::vector<double>& reference);

}  // namespace ringdown::bench
