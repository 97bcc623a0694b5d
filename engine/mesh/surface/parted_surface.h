// A body's surface with closed surfaces inside that divide the body into regions of different materials. [worker]
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
  std::string name;  // used in messages and for the group of elements inside
  TriangleMesh mesh;
};

// Shells are wound alternately: the region directly inside an outermost shell is enclosed, the region inside the next
// shell is not, and so on. So the surface bounds a body that consists of every second region.
struct PartedSurface {
  TriangleMesh mesh;
  std::vector<std::int32_t> source;  // for each triangle a position in `names`, or -1 for the body's own surface
  std::vector<std::string> names;    // names of the inner surfaces
};

// The region between a shell and the shells directly within it.
struct Region {
  bool filled = false;     // false: a cavity of the body
  std::int32_t part = -1;  // the innermost inner surface around the region; -1: none
  double volume_m3 = 0;
};

// Returns one region for each of the shells of shells_of(). `source` gives the surface that each shell comes from.
std::vector<Region> regions_of(const Shells& shells, const std::vector<std::int32_t>& source);

// Returns the source of each shell of `mesh`, a surface that was cut into new triangles, by the nearest original
// triangles.
std::vector<std::int32_t> sources_of(const Shells& shells, const TriangleMesh& mesh, const PartedSurface& parted);

// Joins the surfaces, all of which must be sound. Fails with one sentence if two surfaces cross or touch, if an inner
// surface lies outside the body or in a cavity, or if two have one name.
Result<PartedSurface> part(const TriangleMesh& body, const std::vector<NamedSurface>& inner, const std::string& name);

}  // namespace ringdown::mesh
