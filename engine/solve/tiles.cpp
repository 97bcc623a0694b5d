#include "engine/solve/tiles.h"

namespace ringdown::solve {
namespace {

constexpr int kAhead = 512;  // numbers by which tiles are fetched before their turn

// Columns in a tile of a strip's own rows: up to and with the tile's own.
int columns_of(int tile, int width) { return std::min(kTile * (tile + 1), width); }

int own_tiles(int width) { return (width + kTile - 1) / kTile; }

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
    for (int r = first; r < std::min(first + kTile, strip.below); ++r) *sides.below(r, width) -= sum[r - first];
  }
}

RINGDOWN_CLONES
void solve_up_below(const Strip& strip, const double* tiles, const Sides& sides, int begin, int end) {
  Lanes* const y = lanes(sides.own);
  const int width = strip.width;
  const std::ptrdiff_t ahead =
      std::max(kAhead, kTile * width);  // the same columns of the next tile when there are many
  tiles += strip.offset + strip.triangle();
  for (int first = 0; first < strip.below; first += kTile, tiles += static_cast<std::ptrdiff_t>(kTile) * width) {
    Lanes known[kTile] = {};
    for (int r = first; r < std::min(first + kTile, strip.below); ++r) known[r - first] = *sides.below(r, width);
    const double* tile = tiles + static_cast<std::ptrdiff_t>(kTile) * begin;
    for (int p = begin; p < end; ++p, tile += kTile) {
      __builtin_prefetch(tile + ahead);
      Lanes a = tile[0] * known[0], b = tile[1] * known[1];
      for (int i = 2; i < kTile; i += 2) a += tile[i] * known[i], b += tile[i + 1] * known[i + 1];
      y[p] -= a + b;
    }
  }
}

RINGDOWN_CLONES
void solve_up_own(const Strip& strip, const double* tiles, const Sides& sides) {
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
      for (int i = 2; i < kTile; i += 2) a += column[i] * known[i], b += column[i + 1] * known[i + 1];
      y[p] -= a + b;
    }
  }
}

}  // namespace ringdown::solve
