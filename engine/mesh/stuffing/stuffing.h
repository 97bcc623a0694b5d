// Fills any surface that looks closed with tetrahedra, by isosurface stuffing. [worker]
//
//   Result<Stuffed> stuffed = stuff(soup, {.size_m = 0.003});
//   if (!stuffed) return fail(stuffed);
//
// The surface may be a soup: with holes, doubled or overlapping patches, or cutting itself. Inside is where its winding
// number (winding_number.h) is above one half, so each hole is closed by a smooth skin.
//
// The method is F. Labelle & J. R. Shewchuk, Isosurface Stuffing, ACM Trans. Graph. 26(3), 2007. A body-centred cubic
// lattice is laid over the body. Where an edge of the lattice leaves the body there is a cut point. A lattice point
// with a cut point nearer than kNearLong of a long edge or kNearShort of a short edge moves onto the nearest cut point.
// The part of each tetrahedron that is inside becomes elements (bcc_lattice.h). For every surface, all dihedral angles
// then lie between kMinDihedral and kMaxDihedral; tests/mesh/stuffing/stencil_test.cpp covers all possible cases. (The
// two shares were found by that search; the angles are those that the paper proves for its own shares, 10.78 and 164.74
// degrees.)
//
// All nodes on the skin lie on the surface. Sharp edges would become chamfers up to a cell wide; most are restored
// within these angles (sharpen.h). Features thinner than a cell may get holes or vanish.
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/mesh/triangle_mesh.h"

namespace ringdown::mesh {

inline constexpr double kMaxLatticePoints = 30e6;  // lattice points in the body's box; takes at most 0.3 GB
inline constexpr int kCrumb = 36;                  // parts with fewer elements are removed; three cubes have 36

struct StuffOptions {
  double size_m = 0;    // edge of the lattice's cubes, also the longest edge of its tetrahedra; > 0
  int threads = 0;      // 0: one per processor
  bool sharpen = true;  // whether sharp edges are restored (sharpen.h)
};

struct Stuffed {
  TetMesh mesh;         // elements of four nodes, positively oriented; passes check_mesh()
  int crumbs = 0;       // number of removed parts with fewer than kCrumb elements
  int hinges = 0;       // number of elements removed so that no parts touch only in an edge or a point
  int sharpened = 0;    // number of the skin's nodes moved onto sharp edges
  bool turned = false;  // the surface was inside out as a whole
};

// A body defined by a test for its inside, for bodies that are not given as triangles.
class Solid {
 public:
  virtual ~Solid() = default;

  // The bounding box of the inside.
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();

  // [any thread, several at once]
  [[nodiscard]] virtual bool inside(const Eigen::Vector3d& point) const = 0;

  // Returns the fraction of the way from a, inside, to b, outside, at which the body ends. Uses bisection by default.
  [[nodiscard]] virtual double exit_fraction(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;

  // Returns true if the whole box is inside or the whole box is outside; false if that is not known.
  [[nodiscard]] virtual bool uniform(const Eigen::Vector3d&, const Eigen::Vector3d&) const { return false; }
};

// Stuffs a surface. The result does not depend on the number of threads. Progress stage: "stuffing". Fails with one
// sentence: no size, nothing is inside, the lattice would be larger than kMaxLatticePoints, cancelled. A winding number
// takes about a microsecond; one is needed at each lattice point near the surface and three at each cut point.
Result<Stuffed> stuff(const TriangleMesh& surface, const StuffOptions& options, const Progress& progress = {});
Result<Stuffed> stuff(const Solid& solid, const StuffOptions& options, const Progress& progress = {});

}  // namespace ringdown::mesh
