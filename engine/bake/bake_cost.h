// Estimates what a bake will take before it is made: modes, processor time and memory. The constants were fitted to
// seven bakes and checked on one other. [any thread]
#pragma once

#include "engine/base/result.h"
#include "engine/bake/body_shape.h"
#include "engine/fem/assembly.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/modal/bank.h"

#include <string>

namespace ringdown::bake {

struct BakeCost {
  double unknowns = 0;
  double modes = 0;         // elastic ones up to the top of the band
  double processor_s = 0;   // once the body is meshed, on a processor like this one
  double memory_bytes = 0;  // at its peak
};

// About how many elastic modes a free body has up to a frequency: those of a solid (debye_count), and those of the
// plate, half as large as its surface, that a thin one is: bending waves, fewer where it is bent as a shell below the
// frequency at which a wave goes once around it, and two kinds of waves in its plane. Or those of a bar, where it is
// slender and these are more.
double expected_modes(const BodyShape& shape, const modal::Material& material, double frequency_hz);

// Estimates the cost of a bake with elements of this kind between the corners of `mesh`, whose own order does not
// matter. Counts nodes, and times a product of two matrices to measure the processor (some 30 ms).
BakeCost expected_cost(const mesh::TetMesh& mesh, fem::Element element, const modal::Material& material,
                       double band_high_hz);

// As above before there is a mesh, from estimated_unknowns().
BakeCost expected_cost(const BodyShape& shape, double size_m, fem::Element element, const modal::Material& material,
                       double band_high_hz);

// Fails when a bake takes clearly more than is free, with a sentence that says how much it takes and what to change.
Result<void> check_memory(const BakeCost& cost, double free_bytes, const std::string& name);

}  // namespace ringdown::bake
