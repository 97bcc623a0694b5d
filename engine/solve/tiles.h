// Triangular solves with one supernode's factor, kWidth right-hand sides at once. [any thread]
//
// The factor's columns (height x pivots, unit lower triangular on top) are kept as tiles of kTile rows: a tile holds
// kTile numbers of the first column, then of the second, and so on. So a solve reads the factor once, in order, and
// keeps kTile x kWidth results in registers: it is bound by the memory's bandwidth, not by arithmetic. The rows of the
// pivots and those below are tiled apart, both filled up with zeros; a tile of pivots ends with its own columns.
//
// Right-hand sides stand as in Block: kWidth numbers for each unknown.
#pragma once

#include "engine/solve/lanes.h"

#include <cstddef>
#include <vector>

namespace ringdown::solve {

inline constexpr int kTile = 8;  // rows

// Numbers in the tiles of a supernode.
std::size_t tiled_size(int pivots, int below);

// Copies a factor from columns of `stride` numbers into `tiles` (tiled_size() of them). The part above the diagonal is
// not read.
void to_tiles(const double* columns, int stride, int pivots, int below, double* tiles);

// x := L^-1 x in the rows of the pivots (`own`, contiguous), and what follows from it subtracted in the rows below,
// which come in threes: node rows[i] begins at 3 * rows[i] * kWidth of `x` for i < split, and of `other` from there on.
void solve_down(const double* tiles, int pivots, const std::vector<int>& rows, int split, double* own, double* x,
                double* other);

// x := L^-T x in the rows of the pivots, given the solution in those below.
void solve_up(const double* tiles, int pivots, const std::vector<int>& rows, double* own, const double* x);

}  // namespace ringdown::solve
