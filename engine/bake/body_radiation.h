// The radiation of a body's modes in units of its own: computed from its finite elements, or taken from the cache.
// [worker]
//
// In a body of length 1 and density 1 with the shapes of BodyModes, the far field F' of a mode depends on its
// wavenumber times the body's length alone. The body's own is then
//
//   k = k' / L,      F = rho^-1/2 L^1/2 F'
//
// so that one solution serves every size, and with it every material of the same speed of sound. Which one it is
// depends neither on damping nor on the density of the air.
#pragma once

#include "engine/bake/body_modes.h"
#include "engine/bake/heard_modes.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/boundary.h"
#include "engine/modal/radiation_map.h"
#include "engine/radiate/body.h"

#include <filesystem>
#include <string>
#include <vector>

namespace ringdown::bake {

struct RadiatingBody {
  const mesh::TetMesh& unit_mesh;  // in units of its characteristic length
  const mesh::Boundary& surface;   // of it
  const BodyUnits& units;
  const BodyModes& modes;
};

struct RadiationReport {
  bool from_cache = false;    // nothing was solved
  std::string cache_trouble;  // why the cache could not be written; the result is none the worse
  int largest_unknowns = 0;   // of the finest surface
};

// The surface that the air touches, and what each mode pushes through it, in units of the body's length. `wavenumbers`
// are those of the modes, times the length.
radiate::Body radiating_surface(const RadiatingBody& body, const std::vector<double>& wavenumbers,
                                const std::vector<HeardMode>& modes);

// Finds what each mode radiates into the air, and writes it into the modes as the body's own: field, error, doubt. What
// the air takes follows from the field. Returns where the fields are measured from [m]. With a cache folder the answer
// is kept there, and the same question gives the same answer to the last bit. Progress stage: "radiation". Fails when
// cancelled, and as radiate::solve() does.
Result<Vec3> find_radiation(const RadiatingBody& body, const modal::Air& air, const std::filesystem::path& cache,
                            std::vector<HeardMode>& modes, RadiationReport& report, const Progress& progress);

}  // namespace ringdown::bake
