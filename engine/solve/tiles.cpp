#include "engine/solve/tiles.h"

#include <algorithm>

namespace ringdown::solve {
namespace {

int tiles_of(int rows) { return (rows + kTile - 1) / kTile; }

// Columns in a tile of pivots: up to and with the tile's own.
int columns_of(int tile, int pivots) { return std::min(kTile * (tile + 1), pivots); }

}  // namespace

std::size_t tiled_size(int pivots, int below) {
  std::size_t size = static_cast<std::size_t>(tiles_of(below)) * kTile * pivots;
  for (int t = 0; t < tiles_of(pivots); ++t) size += static_cast<std::size_t>(kTile) * columns_of(t, pivots);
  return size;
}

void to_tiles(const double* columns, int stride, int pivots, int below, double* tiles) {
  const auto copy = [&](int first_row, int end_row, int first_column, int end_column) {
    const int rows = end_row - first_row;
    for (int c = first_column; c < end_column; ++c, tiles += kTile) {
      const double* from = columns + static_cast<std::ptrdiff_t>(c) * stride + first_row;
      std::copy_n(from, rows, tiles);
      std::fill_n(tiles + rows, kTile - rows, 0.0);
    }
  };
  for (int t = 0; t < tiles_of(pivots); ++t) {
    const int first = kTile * t, end = std::min(first + kTile, pivots);
    copy(first, end, 0, first);
    for (int c = first; c < end; ++c, tiles += kTile) {  // unit lower triangle
      for (int i = 0; i < kTile; ++i) {
        tiles[i] = first + i > c && first + i < end ? columns[static_cast<std::ptrdiff_t>(c) * stride + first + i] : 0;
      }
    }
  }
  for (int first = 0; first < below; first += kTile) {
    copy(pivots + first, pivots + std::min(first + kTile, below), 0, pivots);
  }
}

RINGDOWN_CLONES
void solve_down(const double* tiles, int pivots, const std::vector<int>& rows, int split, double* own, double* x,
                double* other) {
  Lanes* const y = lanes(own);
  for (int first = 0; first < pivots; first += kTile) {
    const int end = std::min(first + kTile, pivots);
    Lanes sum[kTile] = {};
    for (int p = 0; p < first; ++p, tiles += kTile) {
      const Lanes factor = y[p];
      for (int i = 0; i < kTile; ++i) sum[i] += tiles[i] * factor;
    }
    for (int p = first; p < end; ++p, tiles += kTile) {
      const Lanes factor = y[p] -= sum[p - first];
      for (int i = 0; i < kTile; ++i) sum[i] += tiles[i] * factor;
    }
  }
  const int below = 3 * static_cast<int>(rows.size());
  for (int first = 0; first < below; first += kTile) {
    Lanes sum[kTile] = {};
    for (int p = 0; p < pivots; ++p, tiles += kTile) {
      const Lanes factor = y[p];
      for (int i = 0; i < kTile; ++i) sum[i] += tiles[i] * factor;
    }
    for (int r = first; r < std::min(first + kTile, below); ++r) {
      *lanes(r < 3 * split ? x : other, 3 * static_cast<std::ptrdiff_t>(rows[r / 3]) + r % 3) -= sum[r - first];
    }
  }
}

RINGDOWN_CLONES
void solve_up(const double* tiles, int pivots, const std::vector<int>& rows, double* own, const double* x) {
  Lanes* const y = lanes(own);
  const int below = 3 * static_cast<int>(rows.size());
  for (int t = 0; t < tiles_of(pivots); ++t) tiles += static_cast<std::ptrdiff_t>(kTile) * columns_of(t, pivots);
  const double* const after_pivots = tiles;
  for (int first = 0; first < below; first += kTile) {
    Lanes known[kTile] = {};
    for (int r = first; r < std::min(first + kTile, below); ++r) {
      known[r - first] = *lanes(x, 3 * static_cast<std::ptrdiff_t>(rows[r / 3]) + r % 3);
    }
    for (int p = 0; p < pivots; ++p, tiles += kTile) {
      Lanes a = tiles[0] * known[0], b = tiles[1] * known[1];
      for (int i = 2; i < kTile; i += 2) a += tiles[i] * known[i], b += tiles[i + 1] * known[i + 1];
      y[p] -= a + b;
    }
  }
  tiles = after_pivots;
  for (int t = tiles_of(pivots) - 1; t >= 0; --t) {
    const int first = kTile * t, end = columns_of(t, pivots);
    tiles -= static_cast<std::ptrdiff_t>(kTile) * end;
    const double* corner = tiles + static_cast<std::ptrdiff_t>(kTile) * first;
    Lanes known[kTile] = {};
    for (int p = end - 1; p >= first; --p) {
      Lanes value = y[p];
      const double* column = corner + static_cast<std::ptrdiff_t>(kTile) * (p - first);
      for (int i = p - first + 1; i < kTile; ++i) value -= column[i] * known[i];
      y[p] = known[p - first] = value;
    }
    for (int p = 0; p < first; ++p) {
      const double* column = tiles + static_cast<std::ptrdiff_t>(kTile) * p;
      Lanes a = column[0] * known[0], b = column[1] * known[1];
      for (int i = 2; i < kTile; i += 2) a += column[i] * known[i], b += column[i + 1] * known[i + 1];
      y[p] -= a + b;
    }
  }
}

}  // namespace ringdown::solve
