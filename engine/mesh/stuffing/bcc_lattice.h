// The body-centred cubic lattice: the corners and centres of a block of cubes, and the tetrahedra between them.
// [any thread]
//
// A point has whole coordinates in halves of a cube's edge, all even (a corner) or all odd (a centre). A long edge
// joins two neighbouring corners or centres and has the length of a cube's edge; a short edge joins a corner and a
// centre and has sqrt(3)/2 of that length. All tetrahedra are congruent: two opposite long edges, four short edges,
// angles of 60 and 90 degrees.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>

namespace ringdown::mesh {

class BccLattice {
 public:
  using Site = Eigen::Vector3i;

  BccLattice() = default;
  BccLattice(const Eigen::Vector3d& origin, double size_m, const Eigen::Vector3i& cubes)
      : origin_(origin), size_(size_m), cubes_(cubes) {}

  [[nodiscard]] const Eigen::Vector3i& cubes() const { return cubes_; }
  [[nodiscard]] std::int32_t corner_count() const { return (cubes_.array() + 1).prod(); }
  [[nodiscard]] std::int32_t point_count() const { return corner_count() + cubes_.prod(); }

  [[nodiscard]] bool has(const Site& site) const {
    return (site.array() >= 0).all() && (site.array() <= 2 * cubes_.array()).all();
  }

  [[nodiscard]] std::int32_t number(const Site& site) const {
    const Eigen::Vector3i half = site / 2;
    if (site[0] % 2) return corner_count() + (half[2] * cubes_[1] + half[1]) * cubes_[0] + half[0];
    return (half[2] * (cubes_[1] + 1) + half[1]) * (cubes_[0] + 1) + half[0];
  }

  [[nodiscard]] Site site(std::int32_t number) const {
    const bool centre = number >= corner_count();
    const Eigen::Vector3i count = centre ? cubes_ : Eigen::Vector3i(cubes_.array() + 1);
    const int n = centre ? number - corner_count() : number;
    const Site half(n % count[0], n / count[0] % count[1], n / count[0] / count[1]);
    return 2 * half + Site::Constant(centre ? 1 : 0);
  }

  [[nodiscard]] Eigen::Vector3d point(const Site& site) const { return origin_ + size_ / 2 * site.cast<double>(); }

  // The directions to the 14 neighbours; the first six are long. The opposite of direction d is d ^ 1.
  static constexpr int kDirections = 14, kLongDirections = 6;
  static Site direction(int number) {
    static const std::array<Site, kDirections> directions = {{{2, 0, 0},
                                                              {-2, 0, 0},
                                                              {0, 2, 0},
                                                              {0, -2, 0},
                                                              {0, 0, 2},
                                                              {0, 0, -2},
                                                              {1, 1, 1},
                                                              {-1, -1, -1},
                                                              {1, 1, -1},
                                                              {-1, -1, 1},
                                                              {1, -1, 1},
                                                              {-1, 1, -1},
                                                              {-1, 1, 1},
                                                              {1, -1, -1}}};
    return directions[number];
  }

  // Returns the corners of tetrahedron `number` of the 12 that belong to the cube with this centre: those that lie
  // across its faces towards larger x, y and z. Long edges join corners 0 and 1, and 2 and 3. Positively oriented.
  [[nodiscard]] static std::array<Site, 4> tetrahedron(const Site& centre, int number) {
    const int axis = number / 4, side = number % 4, u = (axis + 1) % 3, v = (axis + 2) % 3;
    constexpr std::array<std::array<int, 2>, 4> kRound = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    std::array<Site, 4> corners = {centre, centre, centre, centre};
    corners[1][axis] += 2;
    for (int k = 0; k < 2; ++k) {
      corners[2 + k][axis] += 1;
      corners[2 + k][u] += kRound[(side + k) % 4][0];
      corners[2 + k][v] += kRound[(side + k) % 4][1];
    }
    return corners;
  }

 private:
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double size_ = 1;
  Eigen::Vector3i cubes_ = Eigen::Vector3i::Zero();
};

// The stencil: the elements with which isosurface stuffing fills one tetrahedron of the lattice. [any thread]
//
// Corners are inside, outside or on the surface; an edge from inside to outside has a cut point. The part inside is a
// tetrahedron, a pyramid or a prism with corners at lattice and cut points. If a face of the lattice has two corners
// inside and one outside, a quadrilateral of it is inside, and both neighbours must choose the same diagonal
// (Labelle & Shewchuk 2007, section 3): the diagonal that ends at the cut point of the long edge; if both cut edges are
// short, the diagonal whose lattice point has an even number of coordinates greater than its cut point's.

enum class Side : std::int8_t { outside = -1, surface = 0, inside = 1 };

// A corner of the lattice's tetrahedron (a == b), or the cut point between a, inside, and b, outside.
struct StencilPoint {
  std::int8_t a = 0, b = 0;
};

struct Stencil {
  int count = 0;
  std::array<std::array<StencilPoint, 4>, 3> elements;  // orientation not specified
};

// Distance between cut point and lattice point, as a share of a long or a short edge, below which the lattice point
// moves onto the cut point (stuffing.h); and the bounds of the dihedral angles [degrees] that result for every surface.
// The two shares were found by searching the space that tests/mesh/stuffing/stencil_test.cpp covers.
inline constexpr double kNearLong = 0.285, kNearShort = 0.3978;
inline constexpr double kMinDihedral = 10.74, kMaxDihedral = 164.71;

// `sites` must be in the order of BccLattice::tetrahedron().
Stencil stencil(const std::array<BccLattice::Site, 4>& sites, const std::array<Side, 4>& sides);

}  // namespace ringdown::mesh
