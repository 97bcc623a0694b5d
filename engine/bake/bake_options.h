// Options and results of a bake (bake.h).
#pragma once

#include "engine/bake/body_radiation.h"
#include "engine/bake/cavity/cavity.h"
#include "engine/bake/liquid/filling.h"
#include "engine/bake/makeup.h"
#include "engine/bake/tubes/resonator.h"
#include "engine/fem/assembly.h"
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
  Liquids liquids;              // in the body and around it (liquid/wet_body.h)
  std::vector<Resonator> resonators;  // tubes under it (tubes/tubes.h); they need `air`
  std::optional<CavityPlan> cavity;   // whose air has modes of its own; needs `air`
  solve::Method solver = solve::Method::kAutomatic;
  int processes = 2;           // of solve::Method::kSlepc
  bool may_be_silent = false;  // a body without a mode in its band gets a bank of no modes; else it fails
  bool interior = false;       // returns the modes at every node, too, and solves even if the cache has them
  bool equations = false;      // with `interior`: the matrices, too
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
  double heat_seconds = 0, liquid_seconds = 0, tube_seconds = 0, cavity_seconds = 0;
  double radiation_seconds = 0, nonlinear_seconds = 0;
  std::vector<double> hardening;                 // own_hardening() of the modes that have nonlinear terms, by frequency
  std::vector<std::size_t> hardened;             // which of these the bank's terms are, in their order
  double membrane_share = 0, carried_share = 0;  // as in NonlinearModes
  solve::Agreement agreement;  // of the second opinion; of no modes when nothing was solved or none was asked for
  double largest_error = 0;    // estimated, relative, of any mode's frequency in the band, dropped ones included
};

}  // namespace ringdown::bake
