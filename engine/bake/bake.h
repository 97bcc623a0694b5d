// Mesh + material -> bank. [worker]
//
//   Result<Baked> baked = bake(mesh, material, {}, "bell");
//   if (!baked) return fail(baked.error());
//   return modal::write_bank(baked->bank, "bell.glb");
#pragma once

#include "engine/base/progress.h"
#include "engine/fem/assembly.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/modal/bank.h"
#include "engine/solve/eigensolver.h"

#include <string>

namespace ringdown::bake {

struct BakeOptions {
  fem::Element element = fem::Element::kTet10; // the mesh is brought to its order
  double band_low_hz = 20, band_high_hz = 20000;
  std::size_t most_points = 200; // on the surface, >= 4. Fewer points, not coarser physics
  int most_modes = 4096;         // in the band; a fuller band fails (see solve::EigenRequest)
  int keep_modes = 0;            // the most important ones go into the bank; 0: all
  solve::Method solver = solve::Method::kAutomatic;
  int processes = 2; // of solve::Method::kSlepc
};

struct BakeReport {
  Eigen::Index unknowns = 0, elements = 0;
  int rigid = 0;       // dropped
  int below_band = 0;  // dropped
  int over_damped = 0; // dropped: they have no pitch
  int unimportant = 0; // dropped by keep_modes
  double assemble_seconds = 0, factor_seconds = 0, iterate_seconds = 0, finish_seconds = 0;
};

struct Baked {
  modal::Bank bank;
  BakeReport report;
};

// The modes of the free body whose damped frequency lies in the band, in order of importance(), with
// everything else that a bank holds. Shapes are exact nodal values at the kept surface points; the sign of
// each is chosen so that its largest component is positive. Progress stages: "assemble", "factors", "modes",
// "finish".
//
// Fails when the material is not stable, when the eigensolver fails, when no mode lies in the band, or when
// the body has more motions without energy than six for each piece: then parts hang together at an edge or a
// point like a hinge.
Result<Baked> bake(const mesh::CheckedMesh& mesh, const modal::Material& material, const BakeOptions& options,
                   const std::string& name, const Progress& progress = {});

// The largest lambda whose mode may still lie below band_high_hz: the smaller root of
// lambda - ((alpha + beta lambda) / 2)^2 = (2 pi f)^2, or where it would reach the most damped pitch of all.
double highest_lambda_in_band(double band_high_hz, modal::RayleighDamping damping);

} // namespace ringdown::bake
