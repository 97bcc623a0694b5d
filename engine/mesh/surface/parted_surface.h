// A body's surface with closed surfaces inside it, which part it into regions of different materials. [worker]
//
//   Result<PartedSurface> parted = part({cup, {{"clay.stl", clay}}}, "cup.stl");
//   Result<Filled> filled = fill_parts(*parted, options, "cup.stl");    // fill.h
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/surface/shells.h"
#include "engine/mesh/triangle_mesh.h"

#include <cstdint>
#include <string>
#include <vector>

namespace ringdown::mesh {

struct NamedSurface {
  std::string name;  // for sentences, and of the group of elements inside
  TriangleMesh mesh;
};

// Shells are wound in turn: what lies directly inside an outermost shell is enclosed, what lies inside a shell within
// it is not, and so on. So the surface bounds a body, that of every second region.
struct PartedSurface {
  TriangleMesh mesh;
  std::vector<std::int32_t> source;  // of each triangle: a number in `names`, or -1: of the body's own surface
  std::vector<std::string> names;    // of the inner surfaces
};

// The region directly inside a shell, as far as to the shells within it.
struct Region {
  bool filled = false;     // not a cavity of the body
  std::int32_t part = -1;  // the innermost inner surface around it; -1: none
  double volume_m3 = 0;
};

// One for each of shells_of(), whose shells come from the surfaces that `source` says.
std::vector<Region> regions_of(const Shells& shells, const std::vector<std::int32_t>& source);

// The source of each shell of `shells`, a surface that has been cut into other triangles, by what lies nearest.
std::vector<std::int32_t> sources_of(const Shells& shells, const TriangleMesh& mesh, const PartedSurface& parted);

// All surfaces must be sound. Fails with one sentence when two of them cross or touch, when an inner one lies outside
// of the body or in a cavity, or when there are two of one name.
Result<PartedSurface> part(const TriangleMesh& body, const std::vector<NamedSurface>& inner, const std::string& name);

}  // namespace ringdown::mesh
