// What is wrong with a surface, before anything is done about it. [worker]
//
//   const SurfaceReport report = diagnose(mesh);
//   for (const Finding& finding : report.findings) puts(describe(finding).c_str());
//   if (report.sound()) ...gmsh can fill it...
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <array>
#include <string>
#include <vector>

namespace ringdown::mesh {

enum class Fault {
  kUnusedPoints,      // no triangle has them
  kDegenerate,        // a triangle without area
  kDuplicate,         // a triangle with the corners of another
  kSliver,            // a triangle lower than a hundredth of its longest side; harmless, but told
  kCrowdedEdge,       // more than two triangles at an edge
  kHole,              // a closed run of edges with one triangle
  kFlipped,           // a triangle turned against its neighbours
  kSelfIntersection,  // two triangles that cut each other
  kInsideOut,         // a shell that is turned inward where it should be outward, or the other way about
  kSeveralShells,     // closed parts beside each other; harmless: they are pieces of one body
  kCavity,            // closed parts inside others; harmless: the body is hollow there
  kOverlap,           // shells that cut each other
  kSheet,             // open so wide that it encloses nothing
  kNoVolume,          // closed, but flat
};

// Told, but no obstacle to filling.
bool is_harmless(Fault fault);

struct Finding {
  Fault fault;
  std::size_t count = 0;
  std::vector<Eigen::RowVector3d> places;  // [m] of the first kMaxPlaces
  std::vector<std::int32_t> triangles;     // the first kMaxPlaces, numbers in the mesh; none for unused points
  double length_m = 0;                     // of holes: the longest perimeter
};

inline constexpr std::size_t kMaxPlaces = 3;
inline constexpr std::size_t kMaxIntersections = 1000;  // counted; more are "at least" that many

struct SurfaceReport {
  std::vector<Finding> findings;
  int shells = 0;        // parts joined by edges
  double volume_m3 = 0;  // as far as it is closed
  double area_m2 = 0;
  double diagonal_m = 0;  // of its box

  [[nodiscard]] const Finding* find(Fault fault) const;
  [[nodiscard]] bool closed() const;  // no edge with one triangle, or more than two
  // Closed, consistent, cut by nothing, turned outward, with volume: it bounds a body.
  [[nodiscard]] bool sound() const;
};

// Node numbers must be in range and coordinates finite. O(T log T); shells are compared in O(shells T).
SurfaceReport diagnose(const TriangleMesh& mesh);

// "3 holes, the longest 0.0123 m around, at (0.1, 0, 0.05) m" and the like. No full stop.
std::string describe(const Finding& finding);
std::string name_of(Fault fault);  // "holes", "flipped triangles": for tables

// Where a surface cuts itself. [any thread]

// Pairs of triangles that have more in common than their shared corners, up to `most`, the lower number first. Exact
// (CGAL's predicates); degenerate triangles and copies of others are passed over. O(T log T) where few boxes of
// triangles meet.
std::vector<std::array<std::int32_t, 2>> self_intersections(const TriangleMesh& mesh, std::size_t most);

}  // namespace ringdown::mesh
