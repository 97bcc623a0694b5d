// Tetrahedra inside any surface that looks closed: isosurface stuffing. [worker]
//
//   Result<Stuffed> stuffed = stuff(soup, {.size_m = 0.003});
//   if (!stuffed) return fail(stuffed.error());
//
// The surface may be a soup: with holes, doubled or overlapping patches, cutting itself. Inside is where its winding
// number (winding_number.h) is above one half, so a hole is closed by the smoothest skin across it.
//
// F. Labelle & J. R. Shewchuk, Isosurface Stuffing, ACM Trans. Graph. 26(3), 2007: a body-centred cubic lattice is laid
// over the body; where an edge of it leaves the body there is a cut point; lattice points that have a cut point nearer
// than kNearLong of a long edge or kNearShort of a short one move onto the nearest; and each tetrahedron of the lattice
// gives the part of it that is inside (bcc_lattice.h). Whatever the surface is, every dihedral angle then lies between
// kMinDihedral and kMaxDihedral: no more is possible than what tests/mesh/stuffing/stencil_test.cpp goes through. (The
// two shares were searched for there: they give the angles that the paper proves of its own, 10.78 and 164.74 degrees.)
//
// All nodes on the skin lie on the surface. Sharp edges would become chamfers up to a cell wide; most are drawn out
// again within the same angles (sharpen.h). What is thinner than a cell may get holes or vanish.
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/mesh/triangle_mesh.h"

namespace ringdown::mesh {

inline constexpr double kMaxLatticePoints = 30e6;  // of the lattice over the body's box: 0.3 GB at the most
inline constexpr int kCrumb = 36;                  // elements, those of three cubes: smaller parts are removed

struct StuffOptions {
  double size_m = 0;    // edge of the lattice's cubes, which is the longest edge of its tetrahedra; > 0
  int threads = 0;      // 0: as many as there are processors
  bool sharpen = true;  // sharpen.h
};

struct Stuffed {
  TetMesh mesh;         // of four nodes, positively oriented; passes check_mesh()
  int crumbs = 0;       // parts of fewer than kCrumb elements, removed
  int hinges = 0;       // elements removed so that nothing hangs by an edge or a point
  int sharpened = 0;    // nodes of the skin moved onto sharp edges
  bool turned = false;  // the surface was inside out as a whole
};

// A body that knows its inside; for everything else than triangles.
class Solid {
 public:
  virtual ~Solid() = default;

  // The box that everything inside lies in.
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();

  // [any thread, several at once]
  [[nodiscard]] virtual bool inside(const Eigen::Vector3d& point) const = 0;

  // From a, inside, to b, outside: the fraction of the way at which the body is left. By bisection.
  [[nodiscard]] virtual double exit_fraction(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;

  // The box is inside or outside as a whole, as its middle is. False when that is not known.
  [[nodiscard]] virtual bool uniform(const Eigen::Vector3d&, const Eigen::Vector3d&) const { return false; }
};

// The same bits for any number of threads. Progress stage: "stuffing". Fails with one sentence: no size, nothing is
// inside, the lattice would be larger than kMaxLatticePoints, cancelled. A winding number takes about a microsecond,
// one is needed at each lattice point near the surface and three at each cut point.
Result<Stuffed> stuff(const TriangleMesh& surface, const StuffOptions& options, const Progress& progress = {});
Result<Stuffed> stuff(const Solid& solid, const StuffOptions& options, const Progress& progress = {});

}  // namespace ringdown::mesh
