// The sound field of a vibrating body: for each mode what it radiates, by boundary elements. [worker]
//
// The body is a closed surface in unbounded air. Its modes are given as flow: at sample points on the surface the
// integral of phi.n over the patch that the sample stands for. Integrals, not values, because the net flow of a mode
// decides how loud it is while it is 1e-3 to 1e-5 of what flows back and forth.
//
//   radiate::Body body{.surface = skin, .flow = radiate::flow_of(skin, shapes), .frequency_hz = frequencies};
//   Result<radiate::Radiation> radiation = radiate::solve(body, air, {.threads = 2});
//   bank.radiation = radiation->maps;   radiation->modes[m].decay_per_s
//
// docs/how/radiation.md has the equations and how far the results can be trusted.
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/modal/radiation_map.h"
#include "engine/radiate/body.h"

#include <string>
#include <vector>

namespace ringdown::radiate {

struct Options {
  int threads = 0;              // 0: $RINGDOWN_THREADS, or all processors; results do not depend on it
  Progress progress;            // called from one thread at a time; false stops
  double panels_per_wave = 3;   // edges of triangles per wavelength in the air, to begin with
  double panels_per_shape = 6;  // and per wavelength of the mode's own pattern, which may be shorter
  // Nodes of the finest surface, to which modes come that miss wanted_error_db() on coarser ones; with s mirror planes
  // 2^((s + 1)/2) times as many. A thread takes 12 bytes times the square of the nodes, over 2^s, all share 30 where
  // that leaves room for it; fewer threads run where all together is more than 3.5 GiB.
  int max_unknowns = 8000;
  bool symmetry = true;      // looks for mirror planes and uses them
  double range_octaves = 1;  // levels are given this far below and, up to the highest mode, above a mode's own k
};

// The radiation of one mode, with its error.
struct RadiatedMode {
  double power_w = 0;      // at a modal velocity of amplitude 1 kg^1/2 m/s
  double decay_per_s = 0;  // of its amplitude, by radiation alone
  double relative_db = 0;  // power over that of a pulsating sphere of the same area and mean square velocity
  double error_db = 0;     // what is claimed: the larger of the two below
  double source_db = 0;    // error for a source inside the body, whose exterior field is known, near this wavenumber
  double coarser_db = 0;   // change of the power from the finest surface solved to the limit of ever finer ones
  std::string reason;      // why error_db is above what is wanted (wanted_error_db); empty when it is not
};

// At most this much for a mode that radiates better than 60 dB below a pulsating sphere, else 3 dB.
inline double wanted_error_db(double relative_db) { return relative_db > -60 ? 0.5 : 3; }

struct Radiation {
  modal::RadiationMaps maps;        // of M modes
  std::vector<RadiatedMode> modes;  // M
  int largest_unknowns = 0;         // nodes of the finest surface, its mirror images included
  int mirrors = 0;                  // mirror planes that were used
  int eliminations = 0;             // of matrices with which the iteration did not converge
};

// Fails when the surface is not closed or turned inside out, when sizes do not agree (bad_input), when memory does not
// suffice (no_memory), or with ErrorKind::cancelled. A mode that cannot be resolved by `max_unknowns` is no failure:
// its error and reason say so. About a minute of one core for a bell of 30 cm up to 12 kHz.
Result<Radiation> solve(const Body& body, const modal::Air& air, const Options& options = {});

}  // namespace ringdown::radiate
