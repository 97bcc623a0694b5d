#include "engine/solve/tiles.h"

namespace ringdown::solve {
namespace {

constexpr int kAhead = 512;  // doubles of the tiles that are prefetched ahead of their use

// The number of columns in a tile of a strip's own rows: up to the tile's last row.
int columns_of(int tile, int width) { return std::min(kTile * (tile + 1), width); }

int own_tiles(int width) { return (width + kTile - 1) / kTile; }

static_assert(kTile == kWidth, "Lanes hold a column of a tile");

[[gnu::always_inline]] inline double sum_of(const Lanes& v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

// The four solves for one right-hand side, with the arguments of the solves for kWidth below.

RINGDOWN_CLONES
void solve_one_down_own(const Strip& strip, const double* tiles, const Sides& sides) {
  double* const y = sides.own;
  tiles += strip.offset;
  for (int first = 0; first < strip.width; first += kTile) {
    const int end = std::min(first + kTile, strip.width);
    Lanes even{}, odd{};
    for (int p = 0; p < first; p += 2, tiles += 2 * kTile) {
      even += y[p] * *lanes(tiles);
      odd += y[p + 1] * *lanes(tiles, 1);
    }
    even += odd;
    for (int p = first; p < end; ++p, tiles += kTile) {
      y[p] -= even[p - first];
      even += y[p] * *lanes(tiles);
    }
  }
}

RINGDOWN_CLONES
void solve_one_down_below(const Strip& strip, const double* tiles, const Sides& sides, int begin, int end) {
  const double* const y = sides.own;
  const int width = strip.width;
  tiles += strip.offset + strip.triangle() + static_cast<std::ptrdiff_t>(begin) * kTile * width;
  for (int first = kTile * begin; first < std::min(kTile * end, strip.below); first += kTile) {
    Lanes sums[3] = {};
    for (int p = 0; p < width; p += 3, tiles += 3 * kTile) {  // a strip holds whole nodes
      __builtin_prefetch(tiles + kAhead), __builtin_prefetch(tiles + kAhead + kTile);
      for (int i = 0; i < 3; ++i) sums[i] += y[p + i] * *lanes(tiles, i);
    }
    const Lanes sum = sums[0] + sums[1] + sums[2];
    for (int r = first; r < std::min(first + kTile, strip.below); ++r) *sides.below(r, width) -= sum[r - first];
  }
}

// A column's products are added up tile by tile, and only at the end across the tile's rows.
RINGDOWN_CLONES
void solve_one_up_below(const Strip& strip, const double* tiles, const Sides& sides, int begin, int end) {
  const int width = strip.width;
  Lanes sums[kStrip];
  for (int p = begin; p < end; ++p) sums[p] = Lanes{};
  tiles += strip.offset + strip.triangle();
  for (int first = 0; first < strip.below; first += kTile, tiles += static_cast<std::ptrdiff_t>(kTile) * width) {
    Lanes known{};
    for (int r = first; r < std::min(first + kTile, strip.below); ++r) known[r - first] = *sides.below(r, width);
    for (int p = begin; p < end; ++p) {
      __builtin_prefetch(tiles + static_cast<std::ptrdiff_t>(kTile) * p + kAhead);
      sums[p] += known * *lanes(tiles, p);
    }
  }
  for (int p = begin; p < end; ++p) sides.own[p] -= sum_of(sums[p]);
}

RINGDOWN_CLONES
void solve_one_up_own(const Strip& strip, const double* tiles, const Sides& sides) {
  double* const y = sides.own;
  Lanes sums[kStrip];
  for (int p = 0; p < strip.width; ++p) sums[p] = Lanes{};
  tiles += strip.offset + strip.triangle();
  for (int t = own_tiles(strip.width) - 1; t >= 0; --t) {
    const int first = kTile * t, end = columns_of(t, strip.width);
    tiles -= static_cast<std::ptrdiff_t>(kTile) * end;
    Lanes known{};  // entries not yet known are zero; a tile is zero on and above the diagonal
    for (int p = end - 1; p >= first; --p) y[p] = known[p - first] = y[p] - sum_of(sums[p] + known * *lanes(tiles, p));
    for (int p = 0; p < first; ++p) sums[p] += known * *lanes(tiles, p);
  }
}

}  // namespace

std::size_t Strip::triangle() const {
  std::size_t size = 0;
  for (int t = 0; t < own_tiles(width); ++t) size += static_cast<std::size_t>(kTile) * columns_of(t, width);
  return size;
}

std::vector<Strip> strips_of(int pivots, int below) {
  std::vector<Strip> strips;
  for (Strip strip(pivots, below); strip.width > 0; strip = strip.next(pivots, below)) strips.push_back(strip);
  return strips;
}

std::size_t tiled_size(int pivots, int below) {
  std::size_t size = 0;
  for (Strip strip(pivots, below); strip.width > 0; strip = strip.next(pivots, below)) size += strip.size();
  return size;
}

void to_tiles(const Strip& strip, const double* columns, int stride, double* tiles) {
  const int width = strip.width;
  const double* const corner = columns + static_cast<std::ptrdiff_t>(strip.first) * stride + strip.first;
  double* to = tiles + strip.offset;
  const auto copy = [&](int first_row, int rows, int end_column) {
    for (int c = 0; c < end_column; ++c, to += kTile) {
      const double* from = corner + static_cast<std::ptrdiff_t>(c) * stride + first_row;
      std::copy_n(from, rows, to);
      std::fill_n(to + rows, kTile - rows, 0.0);
    }
  };
  for (int first = 0; first < width; first += kTile) {
    const int end = std::min(first + kTile, width);
    copy(first, end - first, first);
    for (int c = first; c < end; ++c, to += kTile) {  // unit lower triangle
      for (int i = 0; i < kTile; ++i) {
        to[i] = first + i > c && first + i < end ? corner[static_cast<std::ptrdiff_t>(c) * stride + first + i] : 0;
      }
    }
  }
  for (int first = 0; first < strip.below; first += kTile) {
    copy(width + first, std::min(kTile, strip.below - first), width);
  }
}

RINGDOWN_CLONES
void solve_down_own(const Strip& strip, const double* tiles, const Sides& sides) {
  if (sides.vectors == 1) return solve_one_down_own(strip, tiles, sides);
  Lanes* const y = lanes(sides.own);
  tiles += strip.offset;
  for (int first = 0; first < strip.width; first += kTile) {
    const int end = std::min(first + kTile, strip.width);
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
}

RINGDOWN_CLONES
void solve_down_below(const Strip& strip, const double* tiles, const Sides& sides, int begin, int end) {
  if (sides.vectors == 1) return solve_one_down_below(strip, tiles, sides, begin, end);
  const Lanes* const y = lanes(sides.own);
  const int width = strip.width;
  tiles += strip.offset + strip.triangle() + static_cast<std::ptrdiff_t>(begin) * kTile * width;
  for (int first = kTile * begin; first < std::min(kTile * end, strip.below); first += kTile) {
    Lanes sum[kTile] = {};
    for (int p = 0; p < width; ++p, tiles += kTile) {
      __builtin_prefetch(tiles + kAhead);
      const Lanes factor = y[p];
      for (int i = 0; i < kTile; ++i) sum[i] += tiles[i] * factor;
    }
    for (int r = first; r < std::min(first + kTile, strip.below); ++r) *lanes(sides.below(r, width)) -= sum[r - first];
  }
}

RINGDOWN_CLONES
void solve_up_below(const Strip& strip, const double* tiles, const Sides& sides, int begin, int end) {
  if (sides.vectors == 1) return solve_one_up_below(strip, tiles, sides, begin, end);
  Lanes* const y = lanes(sides.own);
  const int width = strip.width;
  const std::ptrdiff_t ahead = std::max(kAhead, kTile * width);  // reaches the next tile's columns if there are many
  tiles += strip.offset + strip.triangle();
  for (int first = 0; first < strip.below; first += kTile, tiles += static_cast<std::ptrdiff_t>(kTile) * width) {
    Lanes known[kTile] = {};
    for (int r = first; r < std::min(first + kTile, strip.below); ++r) known[r - first] = *lanes(sides.below(r, width));
    const double* tile = tiles + static_cast<std::ptrdiff_t>(kTile) * begin;
    for (int p = begin; p < end; ++p, tile += kTile) {
      __builtin_prefetch(tile + ahead);
      Lanes a = tile[0] * known[0], b = tile[1] * known[1];
      for (int i = 2; i < kTile; i += 2) {
        a += tile[i] * known[i];
        b += tile[i + 1] * known[i + 1];
      }
      y[p] -= a + b;
    }
  }
}

RINGDOWN_CLONES
void solve_up_own(const Strip& strip, const double* tiles, const Sides& sides) {
  if (sides.vectors == 1) return solve_one_up_own(strip, tiles, sides);
  Lanes* const y = lanes(sides.own);
  tiles += strip.offset + strip.triangle();
  for (int t = own_tiles(strip.width) - 1; t >= 0; --t) {
    const int first = kTile * t, end = columns_of(t, strip.width);
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
      for (int i = 2; i < kTile; i += 2) {
        a += column[i] * known[i];
        b += column[i + 1] * known[i + 1];
      }
      y[p] -= a + b;
    }
  }
}

}  // namespace ringdown::solve
