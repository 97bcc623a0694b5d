// Mesh + material -> bank. [worker]
//
//   Result<Baked> baked = bake(mesh, material, {}, "bell");
//   if (!baked) return fail(baked.error());
//   return modal::write_bank(baked->bank, "bell.glb");
#pragma once

#include "engine/bake/body_radiation.h"
#include "engine/bake/makeup.h"
#include "engine/base/progress.h"
#include "engine/fem/assembly.h"
#include "engine/mesh/mesh_check.h"
#include "engine/modal/bank.h"
#include "engine/solve/eigensolver.h"

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::bake {

struct BakeOptions {
  fem::Element element = fem::Element::kTet20;  // the mesh is brought to its order
  double band_low_hz = 20, band_high_hz = 20000;
  bool raise_band = false;        // a body that rings above the band alone gets its lowest modes there; else it fails
  double shape_error = 0.03;      // that amplitudes between sample points may have (sample_points.h)
  std::size_t points = 0;         // on the surface, >= 4: so many, whatever the error. 0: as many as shape_error takes
  int max_modes = 4096;           // in the band; a fuller band fails (see solve::EigenRequest)
  int keep_modes = 0;             // the most important ones go into the bank; 0: all
  std::optional<modal::Air> air;  // that the modes radiate into (body_radiation.h); nothing: radiation is not computed
  double radiation_error = HUGE_VAL;  // only when no frequency's estimated error is above this
  int nonlinear = 0;            // how many of the lowest modes bend each other's pitch (nonlinear_modes.h); 0: none
  int coupled = 0;              // of these, the lowest, exchange energy while they are loud; up to kMaxCoupled
  double floor_db = 0;          // modes inaudible this far below the loudest are dropped (audibility.h); 0: none
  std::filesystem::path cache;  // folder of results that bake() may use and add to (ModeCache); empty: none
  std::string family;           // what relatives of this shape share (ModeCache::expected); empty: the mesh itself
  Makeup makeup;                // grain, parts and supports
  solve::Method solver = solve::Method::kAutomatic;
  int processes = 2;           // of solve::Method::kSlepc
  bool may_be_silent = false;  // a body without a mode in its band gets a bank of no modes; else it fails
  bool interior = false;       // returns the modes at every node, too, and solves even if the cache has them
  bool verify = false;         // asks a second method, and fails when the two disagree (solve::EigenRequest::verify)
};

struct BakeReport {
  Eigen::Index unknowns = 0, elements = 0;
  int rigid = 0;                  // dropped
  int below_band = 0;             // dropped
  int over_damped = 0;            // dropped: they have no pitch
  int inaudible = 0;              // dropped by floor_db
  int unimportant = 0;            // dropped by keep_modes
  bool from_cache = false;        // nothing was assembled or solved
  std::string cache_trouble;      // why the cache could not be written; the bake is none the worse
  std::vector<std::string> held;  // what holds the body, and on how large an area
  RadiationReport radiation;
  double assemble_seconds = 0, factor_seconds = 0, iterate_seconds = 0, estimate_seconds = 0, finish_seconds = 0;
  double heat_seconds = 0;
  double radiation_seconds = 0, nonlinear_seconds = 0;
  std::vector<double> hardening;                 // own_hardening() of the modes that have nonlinear terms, by frequency
  std::vector<std::size_t> hardened;             // which of these the bank's terms are, in their order
  double membrane_share = 0, carried_share = 0;  // as in NonlinearModes
  solve::Agreement agreement;  // of the second opinion; of no modes when nothing was solved or none was asked for
  double largest_error = 0;    // estimated, relative, of any mode's frequency in the band, dropped ones included
};

// The body of a bank as it was solved: for what needs its modes inside of the body.
struct SolvedBody {
  mesh::TetMesh mesh;           // of the element's order [m]
  Eigen::MatrixXd shapes;       // 3N x M, the bank's modes in its order and with its signs [kg^-1/2]
  fem::SparseMatrix node_mass;  // N x N [kg]
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
