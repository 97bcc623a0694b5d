// CalculiX as a peer: a mesh goes to it as an input deck, frequencies come back.
#pragma once

#include "engine/base/result.h"
#include "engine/fem/assembly.h"
#include "engine/mesh/tet_mesh.h"

#include <vector>

namespace ringdown::bench {

struct CalculixRun {
  std::vector<double> frequencies_hz;  // ascending, rigid motions too (as zeros)
  double seconds = 0;                  // the whole run of the program
  double processor_s = 0, peak_mib = 0;
};

// The first `modes` modes of the free body, of 10-node elements, on one thread. Fails when ccx is not there, fails
// itself, or takes longer than limit_s.
Result<CalculixRun> run_calculix(const mesh::TetMesh& mesh, const fem::Elastic& elastic, int modes, double limit_s);

// CalculiX 2.20 integrates the mass of C3D10 over 4 points (seen from its frequencies), which is exact for products of
// degree 2, not for the 4 of quadratic shapes: its frequencies are not quite those of the consistent mass. This is its
// N x N node matrix, so that the comparison can be made to the last printed digit. Straight elements only.
fem::SparseMatrix calculix_mass(const mesh::TetMesh& mesh, double density_kg_m3);

}  // namespace ringdown::bench
