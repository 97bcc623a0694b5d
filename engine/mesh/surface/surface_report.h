// Describes the faults of a surface in words. surface_check.h finds them. [any thread]
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <optional>
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
  kBuried,            // closed parts inside others, wound as they are: bodies that add nothing
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

// "3 holes, the longest 0.0123 m around, at (0.1, 0, 0.05) m" and the like. No full stop.
std::string describe(const Finding& finding);
std::string name_of(Fault fault);  // "holes", "flipped triangles": for tables

// A surface as it came, what was done to it (surface_repair.h), and what is left.
struct PreparedSurface {
  TriangleMesh mesh;  // repaired
  SurfaceReport found, left;
  std::vector<std::string> actions;
  std::vector<std::string> notes;     // of the file's reader
  std::optional<TriangleMesh> rough;  // before noise was smoothed away: how far the body may lie from it; never sent
};

// Why no body can be made of a surface: it is a sheet, or flat. Nothing where one can.
std::string hopeless(const PreparedSurface& surface, const std::string& name);

}  // namespace ringdown::mesh
