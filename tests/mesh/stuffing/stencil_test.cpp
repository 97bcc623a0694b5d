// Every way in which a surface can cut a tetrahedron of the lattice.
#include "engine/mesh/stuffing/bcc_lattice.h"
#include "engine/mesh/stuffing/stuffing.h"
#include "tests/mesh/stuffing/dihedral.h"

#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

namespace ringdown::test {
namespace {

using mesh::BccLattice;
using mesh::Side;
using Site = BccLattice::Site;

constexpr int kMoves =
    BccLattice::kDirections + 1;  // of a point on the surface: as far as it may along an edge, or not at all
constexpr int kCuts = 3;          // of an edge: as near to either end as leaves it in place, and its middle

double near_of(bool is_long) { return is_long ? mesh::kNearLong : mesh::kNearShort; }

struct Case {
  std::array<Site, 4> sites;
  std::array<Side, 4> sides;
  mesh::Stencil parts;
  std::vector<int> movable;                   // corners on the surface
  std::vector<std::pair<int, int>> cuttable;  // edges from inside to outside
};

Case make_case(int number, int sides) {
  Case made{.sites = BccLattice::tetrahedron(Site(5, 5, 5), number)};
  for (int c = 0; c < 4; ++c, sides /= 3) made.sides[c] = static_cast<Side>(sides % 3 - 1);
  for (int a = 0; a < 4; ++a) {
    if (made.sides[a] == Side::surface) made.movable.push_back(a);
    for (int b = 0; b < 4; ++b) {
      if (made.sides[a] == Side::inside && made.sides[b] == Side::outside) made.cuttable.emplace_back(a, b);
    }
  }
  made.parts = mesh::stencil(made.sites, made.sides);
  return made;
}

mesh::TetMesh cut(const Case& one, int moves, int cuts) {
  std::array<Eigen::RowVector3d, 4> corners;
  for (int c = 0; c < 4; ++c) corners[c] = one.sites[c].cast<double>().transpose();
  for (const int c : one.movable) {
    const int direction = moves % kMoves;
    moves /= kMoves;
    if (direction == BccLattice::kDirections) continue;
    corners[c] +=
        near_of(direction < BccLattice::kLongDirections) * BccLattice::direction(direction).cast<double>().transpose();
  }
  std::array<std::array<Eigen::RowVector3d, 4>, 4> cut_points;
  for (const auto& [a, b] : one.cuttable) {
    const double near = near_of(a / 2 == b / 2), share = near + (1 - 2 * near) * (cuts % kCuts) / (kCuts - 1);
    cuts /= kCuts;
    cut_points[a][b] = corners[a] + share * (corners[b] - corners[a]);
  }
  mesh::TetMesh mesh;
  mesh.nodes.resize(4 * one.parts.count, 3);
  mesh.elements.resize(one.parts.count, 4);
  for (int e = 0; e < one.parts.count; ++e) {
    for (int c = 0; c < 4; ++c) {
      const auto [a, b] = one.parts.elements[e][c];
      mesh.nodes.row(4 * e + c) = a == b ? corners[a] : cut_points[a][b];
      mesh.elements(e, c) = 4 * e + c;
    }
  }
  return mesh;
}

int power(int base, std::size_t exponent) { return exponent == 0 ? 1 : base * power(base, exponent - 1); }

TEST(Stencil, TheStencilHasNoWorseAnglesThanPromised) {
  constexpr int kAlike = 12, kSides = 81;  // the twelve tetrahedra of a cube look in another direction each
  Dihedral all;
  for (int number = 0; number < kAlike; ++number) {
    for (int sides = 0; sides < kSides; ++sides) {
      const Case one = make_case(number, sides);
      for (int moves = 0; moves < power(kMoves, one.movable.size()) && one.parts.count > 0; ++moves) {
        for (int cuts = 0; cuts < power(kCuts, one.cuttable.size()); ++cuts) {
          const Dihedral found = dihedral(cut(one, moves, cuts));
          all.min = std::min(all.min, found.min);
          all.max = std::max(all.max, found.max);
        }
      }
    }
  }
  EXPECT_GE(all.min, mesh::kMinDihedral);
  EXPECT_LE(all.max, mesh::kMaxDihedral);
  EXPECT_NEAR(all.min, mesh::kMinDihedral, 0.02) << "the promise is not the best that can be given";
  EXPECT_NEAR(all.max, mesh::kMaxDihedral, 0.02);
}

}  // namespace
}  // namespace ringdown::test
