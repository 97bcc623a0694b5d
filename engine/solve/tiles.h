// Triangular solves with one supernode's factor, for kWidth right-hand sides at once or for one. [any thread]
//
// The factor's columns (height x pivots, unit lower triangular on top) are cut into strips of at most kStrip columns,
// and each strip into tiles of kTile rows: a tile holds kTile numbers of the strip's first column, then of the second,
// and so on. A solve therefore reads the factor once and in order, keeps kTile x kWidth results in registers, and keeps
// the strip's own right-hand sides in the first cache. A strip begins with the tiles of its own rows, each ending with
// its own columns; all rows below follow, those of the supernode's later pivots first. Tiles are padded with zeros.
//
// kWidth right-hand sides are stored as in Block, and a register holds one number of each. With a single right-hand
// side, a register holds kTile numbers, one for each row of a tile. Reading the factors takes as long for one
// right-hand side as for kWidth; the arithmetic takes an eighth.
#pragma once

#include "engine/solve/lanes.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace ringdown::solve {

inline constexpr int kTile = 8;     // rows; equal to the numbers in a Lanes
inline constexpr int kStrip = 120;  // columns

// Some of a supernode's columns: `first` .. `first + width - 1`.
struct Strip {
  int first, width;
  int below;           // rows below the strip's own, the supernode's later pivots included
  std::size_t offset;  // position of the strip's tiles among the supernode's

  Strip(int pivots, int below_supernode) : Strip(0, pivots, below_supernode, 0) {}
  // The next strip; it has no columns when there is none.
  [[nodiscard]] Strip next(int pivots, int below_supernode) const {
    return {first + width, pivots, below_supernode, offset + size()};
  }
  [[nodiscard]] std::size_t size() const { return triangle() + static_cast<std::size_t>(tiles()) * kTile * width; }
  [[nodiscard]] std::size_t triangle() const;                              // numbers in the tiles of own rows
  [[nodiscard]] int tiles() const { return (below + kTile - 1) / kTile; }  // tiles of rows below

 private:
  Strip(int column, int pivots, int below_supernode, std::size_t at)
      : first(column),
        width(std::min(kStrip, pivots - column)),
        below(pivots - column - width + below_supernode),
        offset(at) {}
};

// All strips of a supernode, first to last.
std::vector<Strip> strips_of(int pivots, int below);

// The count of numbers in a supernode's tiles.
std::size_t tiled_size(int pivots, int below);

// Copies a strip of a factor to the supernode's `tiles`, from columns of `stride` numbers, the supernode's first column
// at `columns`. The part above the diagonal is not read.
void to_tiles(const Strip& strip, const double* columns, int stride, double* tiles);

// The right-hand sides of a strip: its own, then those of the supernode's later pivots, then those of the rows below.
struct Sides {
  double* own;
  int later;                     // unknowns of the supernode after the strip's own
  const std::vector<int>* rows;  // nodes below the supernode
  int split;                     // rows[i] is in `x` for i < split, else in `crown`
  int first_of_crown;            // first node of `crown`
  double *x, *crown;
  int vectors;  // kWidth, or 1

  // Row i below the strip's own.
  [[nodiscard]] double* below(int i, int width) const {
    if (i < later) return own + static_cast<std::ptrdiff_t>(width + i) * vectors;
    const int row = (i - later) / 3;
    const std::ptrdiff_t node = (*rows)[row], unknown = (i - later) % 3;
    return row < split ? x + (3 * node + unknown) * vectors : crown + (3 * (node - first_of_crown) + unknown) * vectors;
  }
};

// The two steps of x := L^-1 x. solve_down_own() solves for the strip's own rows; solve_down_below() subtracts their
// products from the rows below, in tiles `begin` to `end`.
void solve_down_own(const Strip& strip, const double* tiles, const Sides& sides);
void solve_down_below(const Strip& strip, const double* tiles, const Sides& sides, int begin, int end);

// The two steps of x := L^-T x. solve_up_below() subtracts the products of the rows below from columns `begin` to `end`
// of the strip; solve_up_own() solves for the strip's own rows.
void solve_up_below(const Strip& strip, const double* tiles, const Sides& sides, int begin, int end);
void solve_up_own(const Strip& strip, const double* tiles, const Sides& sides);

}  // namespace ringdown::solve
