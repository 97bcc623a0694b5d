// Mesh + material -> bank. [worker]
//
//   Result<Baked> baked = bake(mesh, material, {}, "bell");
//   if (!baked) return fail(baked);
//   return modal::write_bank(baked->bank, "bell.glb");
#pragma once

#include "engine/bake/bake_options.h"
#include "engine/bake/body_modes.h"
#include "engine/base/progress.h"
#include "engine/mesh/mesh_check.h"
#include "engine/modal/bank.h"

#include <optional>
#include <string>

namespace ringdown::bake {

// The body of a bank as it was solved: for what needs its modes inside of the body.
struct SolvedBody {
  mesh::TetMesh mesh;                       // of the element's order [m]
  Eigen::MatrixXd shapes;                   // 3N x M, the bank's modes in its order and with its signs [kg^-1/2]
  fem::SparseMatrix node_mass;              // N x N [kg]
  std::optional<Equations> equations = {};  // with options.equations [N/m, kg, kg^-1/2]
};

struct Baked {
  modal::Bank bank;
  std::optional<SolvedBody> body;  // with options.interior
  BakeReport report;
};

// The modes of the body, free or held as options.makeup says, whose damped frequency lies in the band, in order of
// importance() but with inaudible ones last (audibility.h), and everything else that a bank holds. Shapes at the sample
// points are those whose linear interpolation is nearest to the finite elements on the whole surface (sample_points.h);
// the sign of each is chosen so that its largest component on the surface (the first of equals) is positive. Progress
// stages: "assemble", "factors", "modes", "errors", "heat", "nonlinear", "radiation", "finish".
//
// With a cache, a body whose shape, Poisson's ratio (or makeup) and element were solved before, up to the band's top or
// higher, is not solved again: E, density, damping and size rescale exactly (body_modes.h). The bank is the same, byte
// for byte when nothing changed and to rounding when E, density, damping or size did and the same modes are in it; only
// inside a family of equal frequencies (a sphere's, a tube's pairs) may the shapes be another basis of the same
// motions.
//
// With options.air each mode's far field is computed; what the air takes is then part of its decay, and the bank says
// what it radiates and how well that is known.
//
// With options.nonlinear the bank has the nonlinear terms of that many modes, the lowest, or of all it has. These stand
// first, and options.keep_modes and floor_db drop none of them. A body that is too deep a shell for them is refused.
//
// Errors are estimated from what finer elements would add (fem::frequency_errors) and from what rounding leaves of the
// rigid motions' zero energy: in meshes of very flat elements that disturbs the lowest modes. Where the mesh's skin
// does not lie on the body's surface (CheckedMesh::gaps_m), what the gaps do to the frequencies is added
// (fem/shape_change.h).
//
// Fails when a material is not stable, when its makeup does not fit the mesh (fitted_makeup.h), when the eigensolver
// fails or a second opinion disagrees, when no mode lies in the band (unless options.raise_band says otherwise), when
// rounding hides the lowest mode among the rigid motions, or when the body is so far from the origin that a bank's
// positions would lose it.
Result<Baked> bake(const mesh::CheckedMesh& mesh, const modal::Material& material, const BakeOptions& options,
                   const std::string& name, const Progress& progress = {});

}  // namespace ringdown::bake
