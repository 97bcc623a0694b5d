// Describes the faults of a surface in words. surface_check.h finds them. [any thread]
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <optional>
#include <string>
#include <vector>

namespace ringdown::mesh {

enum class Fault {
  kUnusedPoints,      // points that no triangle has
  kDegenerate,        // a triangle without area
  kDuplicate,         // a triangle with the corners of another
  kSliver,            // a triangle lower than a hundredth of its longest side; harmless, but reported
  kCrowdedEdge,       // more than two triangles at an edge
  kHole,              // a closed run of edges with one triangle
  kFlipped,           // a triangle turned against its neighbours
  kSelfIntersection,  // two triangles that cut each other
  kInsideOut,         // a shell that faces inward and should face outward, or faces outward and should face inward
  kSeveralShells,     // closed parts beside each other; harmless: they are pieces of one body
  kCavity,            // closed parts inside others; harmless: the body is hollow there
  kBuried,            // closed parts inside others and wound alike: bodies that add nothing
  kOverlap,           // shells that cut each other
  kSheet,             // a surface so wide open that it encloses nothing
  kNoVolume,          // closed, but flat
};

// Returns true for faults that are reported but do not prevent filling.
bool is_harmless(Fault fault);

struct Finding {
  Fault fault;
  std::size_t count = 0;
  std::vector<Eigen::RowVector3d> places;  // [m], the first kMaxPlaces places
  std::vector<std::int32_t> triangles;     // numbers of the first kMaxPlaces triangles; none for unused points
  double length_m = 0;                     // for holes, the longest perimeter
};

inline constexpr std::size_t kMaxPlaces = 3;
inline constexpr std::size_t kMaxIntersections = 1000;  // a larger number is reported as "at least 1000"

struct SurfaceReport {
  std::vector<Finding> findings;
  int shells = 0;        // number of parts joined by edges
  double volume_m3 = 0;  // meaningful as far as the surface is closed
  double area_m2 = 0;
  double diagonal_m = 0;  // diagonal of the bounding box

  [[nodiscard]] const Finding* find(Fault fault) const;
  [[nodiscard]] bool closed() const;  // every edge has exactly two triangles
  // Returns true if the surface bounds a body: closed, consistent, without cuts, turned outward, with volume.
  [[nodiscard]] bool sound() const;
};

// "3 holes, the longest 0.0123 m around, at (0.1, 0, 0.05) m" and the like. No full stop.
std::string describe(const Finding& finding);
std::string name_of(Fault fault);  // "holes", "flipped triangles": for tables

// A surface with its faults before repair, the repairs (surface_repair.h), and the faults after.
struct PreparedSurface {
  TriangleMesh mesh;  // the repaired surface
  SurfaceReport found, left;
  std::vector<std::string> actions;
  std::vector<std::string> notes;     // notes of the file's reader
  std::optional<TriangleMesh> rough;  // the surface before smoothing, to measure the body's deviation; never sent
};

// Returns the reason why no body can be made of a surface (a sheet, or flat); "" if one can.
std::string hopeless(const PreparedSurface& surface, const std::string& name);

}  // namespace ringdown::mesh
