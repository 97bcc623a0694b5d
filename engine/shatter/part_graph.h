// Bits of a body and the faces between them, and the ways to sort bits into parts. [worker]
//
// A bit is a tetrahedron, or a piece of a finer level; a part is a set of bits.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace ringdown::shatter {

struct PartGraph {
  struct Joint {
    std::int32_t a, b;  // bits
    double area_m2;     // of the faces between them
  };
  std::vector<double> volumes_m3;       // of the bits
  std::vector<Eigen::Vector3d> places;  // their centres [m]
  std::vector<Joint> joints;
};

// Holds the part of each bit. Parts are numbered from 0 in the order of their first bits.
using Parts = std::vector<std::int32_t>;
std::int32_t count_of(const Parts& parts);  // the number of parts

// Bits are in one part if joints connect them within bits of one label. O(n).
Parts connected_parts(const PartGraph& graph, const std::vector<std::int32_t>& labels);

// Parts that hang together by a narrow neck only are divided there. In each part, a fifth of its volume is marked
// around each of two far ends, then a twentieth. The least area A that divides the ends, which is the minimum cut of
// the graph of bits, is a neck if A < kNarrow min(V1, V2)^(2/3), V1 and V2 being the volumes on its two sides. For two
// equal squares of wall, ten wall thicknesses wide, that is a bridge as wide as half a wall's thickness. Necks that do
// not lie between the far ends, or that hold less than a twentieth, are missed. Divided parts are tried again. Bits
// cannot be divided, so the crack is as uneven as they are. The parts must be connected, and so are the resulting ones.
// About O(n^1.5) for a part of n bits.
inline constexpr double kNarrow = 0.025;
Parts parted_at_necks(const PartGraph& graph, const Parts& parts);

// Parts below `least_m3`, the smallest first, join the neighbour with the largest common area; if one of the
// neighbours has the part's `family`, only those count. A family is given for each bit, and a part has that of its
// largest bits. A part without neighbours stays. O(n log n), and O(p^2) for p parts.
Parts joined_small(const PartGraph& graph, const Parts& parts, const std::vector<std::int32_t>& families,
                   double least_m3);

// Return the volume of each part, and for each part the label of the largest share of its volume. O(n log n).
std::vector<double> volumes_of(const PartGraph& graph, const Parts& parts);
std::vector<std::int32_t> main_labels(const PartGraph& graph, const Parts& parts,
                                      const std::vector<std::int32_t>& labels);

// Returns the graph in which each part is one bit, at the centre of its bits. O(n log n).
PartGraph merged(const PartGraph& graph, const Parts& parts);

}  // namespace ringdown::shatter
