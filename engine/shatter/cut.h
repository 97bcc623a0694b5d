// Cuts a body's tetrahedra along the planes between seeds. [worker]
//
//   Result<CutBody> cut = cut_body(body, seeds.points);
//
// The planes are those between the seeds' Voronoi cells, in the straight mesh of the body's corners. Each part of an
// element goes through the element's own curved map, of degree p. Within a part that map is a polynomial of degree p,
// too, so an element of order p reproduces it exactly: the pieces fill the body, whatever its curvature, and any field
// of its finite elements is a field of theirs.
//
// The cuts keep away from the corners they nearly meet, or parts would be too flat for finite elements: where a plane
// divides an edge of an element at less than kLeastShare of its length, the cut goes through the corner instead. Points
// in which three or four cells meet are kept off the sides of their face or element likewise. So a crack is plane but
// for bends of that share of an element, and all other statements stay exact.
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/shatter/refinement.h"

#include <cstdint>
#include <vector>

namespace ringdown::shatter {

inline constexpr double kLeastShare = 0.1;

struct CutBody {
  mesh::Points points;               // N x 3 [m], corners of the parts, where the body's curved elements have them
  std::vector<SubElement> elements;  // parts of the body's elements; neighbours share faces across cells, too
  std::vector<std::int32_t> cell;    // for each part, the seed whose cell it lies in
};

// Cuts the body, which must have passed mesh::check_mesh(), into the cells of `seeds`, K x 3 [m] in the frame of the
// straight mesh. A cell may have several parts that do not touch, and a cell that meets no element has none. Elements
// that are larger than the cells in them are divided first. Fails if there is no seed, more than kMaxSeeds, one that is
// not finite, or two that are nearer to each other than 1e-6 of the body's diagonal. O(E K); 50 ms for 48 seeds and
// 5,000 elements.
inline constexpr int kMaxSeeds = 4096;
Result<CutBody> cut_body(const mesh::TetMesh& body, const mesh::Points& seeds);

}  // namespace ringdown::shatter
