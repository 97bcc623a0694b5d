// The sound field of a vibrating body: the radiation of each mode, by boundary elements. [worker]
//
// The body is a closed surface in unbounded air. Its modes are given as flow: for each sample point on the surface, the
// integral of phi.n over the patch of the sample. Integrals are given instead of values because the loudness of a mode
// depends on its net flow, which is only 1e-3 to 1e-5 of the flow back and forth.
//
//   radiate::Body body{.surface = skin, .flow = radiate::flow_of(skin, shapes), .frequency_hz = frequencies};
//   Result<radiate::Radiation> radiation = radiate::solve(body, air, {.threads = 2});
//   bank.radiation = radiation->maps;   radiation->modes[m].decay_per_s
//
// docs/how/radiation.md has the equations and the accuracy of the results.
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
  double panels_per_wave = 3;   // triangle edges per wavelength in the air, on the first surface
  double panels_per_shape = 6;  // triangle edges per wavelength of the mode's own pattern, which may be shorter
  // Limit of the nodes of the finest surface, on which modes are solved that miss wanted_error_db() on coarser ones.
  // With s mirror planes the limit is 2^((s + 1)/2) times higher. Each thread takes 12 bytes times the square of the
  // nodes, over 2^s. All threads together share 30 bytes times this number if there is room. Fewer threads run if the
  // total exceeds 3.5 GiB.
  int max_unknowns = 8000;
  bool symmetry = true;      // true: finds mirror planes and uses them
  double range_octaves = 1;  // levels cover this much below and above a mode's own k, up to the highest mode
};

// The radiation of one mode, with its error.
struct RadiatedMode {
  double power_w = 0;      // at a modal velocity of amplitude 1 kg^1/2 m/s
  double decay_per_s = 0;  // amplitude decay by radiation alone
  double relative_db = 0;  // power over that of a pulsating sphere of the same area and mean square velocity
  double error_db = 0;     // claimed error: the larger of source_db and coarser_db
  double source_db = 0;    // error for a source inside the body, whose exterior field is known, near this wavenumber
  double coarser_db = 0;   // change of the power from the finest surface solved to the limit of ever finer ones
  std::string reason;      // why error_db exceeds wanted_error_db(); empty if it does not
};

// The largest acceptable error: 0.5 dB for a mode above -60 dB relative to a pulsating sphere, else 3 dB.
inline double wanted_error_db(double relative_db) { return relative_db > -60 ? 0.5 : 3; }

struct Radiation {
  modal::RadiationMaps maps;        // maps of M modes
  std::vector<RadiatedMode> modes;  // M
  int largest_unknowns = 0;         // nodes of the finest surface, mirror images included
  int mirrors = 0;                  // number of mirror planes used
  int eliminations = 0;             // matrices eliminated because the iteration did not converge
};

// Fails when the surface is not closed or turned inside out, when sizes do not agree (bad_input), when memory does not
// suffice (no_memory), or with ErrorKind::cancelled. A mode that cannot be resolved with `max_unknowns` is not a
// failure; its error and reason report it. About a minute of one core for a bell of 30 cm up to 12 kHz.
Result<Radiation> solve(const Body& body, const modal::Air& air, const Options& options = {});

}  // namespace ringdown::radiate
