#include "engine/radiate/wave_matrix.h"

#include "engine/radiate/lanes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace ringdown::radiate {
namespace {

// One node that a side gives weight to, with the weights: of the three components of the curl, then of the normal, then
// of the hat function alone.
struct Share {
  int side;
  float curl[3];
  float normal[3];
  float hat;
};

// Consecutive nodes as the place of y, with the sides around them: few enough that their kernels stay in the cache.
struct Sources {
  int first = 0, last = 0;     // nodes, from and to before
  std::vector<float> middles;  // x, y, z of each side
  std::vector<int> begin;      // last - first + 1: where each node's shares begin
  std::vector<Share> list;     // sides are positions in `middles`
};
constexpr int kNodesOfSources = 192;

Share share_of(const Panels& panels, int number, int position) {
  const Side& side = panels.sides[number];
  Share share{number, {}, {}, 0};
  for (const int triangle : side.triangles) {
    const auto& corners = panels.corners[triangle];
    const auto at = std::find(corners.begin(), corners.end(), side.nodes[position]);
    if (at == corners.end()) continue;
    const double weight = panels.areas[triangle] / 3;
    for (int c = 0; c < 3; ++c) {
      share.curl[c] += static_cast<float>(weight * panels.curls[triangle][at - corners.begin()][c]);
      if (position < 2) share.normal[c] += static_cast<float>(weight / 2 * panels.normals[triangle][c]);
    }
    if (position < 2) share.hat += static_cast<float>(weight / 2);
  }
  return share;
}

std::vector<Sources> sources_of(const Panels& panels) {
  std::vector<std::vector<std::pair<int, int>>> by_node(panels.node_count());  // side, and the node's position at it
  for (int s = 0; s < panels.side_count(); ++s) {
    for (int i = 0; i < 4; ++i) by_node[panels.sides[s].nodes[i]].emplace_back(s, i);
  }
  std::vector<Sources> all;
  for (int first = 0; first < panels.node_count(); first += kNodesOfSources) {
    Sources sources{first, std::min(first + kNodesOfSources, panels.node_count()), {}, {}, {}};
    std::map<int, int> position;
    for (int node = first; node < sources.last; ++node) {
      sources.begin.push_back(static_cast<int>(sources.list.size()));
      for (const auto& [side, at] : by_node[node]) {
        const auto [found, fresh] = position.emplace(side, static_cast<int>(position.size()));
        if (fresh) {
          for (int c = 0; c < 3; ++c) sources.middles.push_back(static_cast<float>(panels.sides[side].middle[c]));
        }
        Share share = share_of(panels, side, at);
        share.side = found->second;
        sources.list.push_back(share);
      }
    }
    sources.begin.push_back(static_cast<int>(sources.list.size()));
    all.push_back(std::move(sources));
  }
  return all;
}

// Sixteen sides as places of the point x; the last are repeated, with weight 0, to make up the number.
struct alignas(64) Block {
  Lanes at[3];
  Lanes curl[4][3], normal[3];
  int nodes[4][kLanes];
};

Block block_of(const Panels& panels, int first) {
  Block block{};
  for (int lane = 0; lane < kLanes; ++lane) {
    const bool real = first + lane < panels.side_count();
    const int number = real ? first + lane : panels.side_count() - 1;
    const Side& side = panels.sides[number];
    for (int c = 0; c < 3; ++c) block.at[c][lane] = static_cast<float>(side.middle[c]);
    for (int i = 0; i < 4; ++i) {
      const Share share = share_of(panels, number, i);
      block.nodes[i][lane] = side.nodes[i];
      for (int c = 0; c < 3; ++c) {
        block.curl[i][c][lane] = real ? share.curl[c] : 0;
        if (i == 0) block.normal[c][lane] = real ? share.normal[c] : 0;
      }
    }
  }
  return block;
}

// G and, with `slopes`, its slope over R between the block's sides and the sources'.
template <bool slopes>
[[gnu::always_inline]] inline void fill_kernels(const Block& block, const Sources& sources, float k, Complexes* waves,
                                                Complexes* over_r) {
  const float scale = static_cast<float>(0.25 / std::numbers::pi);
  const float* const middles = sources.middles.data();
  const int sides = static_cast<int>(sources.middles.size() / 3);
  for (int s = 0; s < sides; ++s) {
    const Lanes dx = block.at[0] - middles[3 * s], dy = block.at[1] - middles[3 * s + 1],
                dz = block.at[2] - middles[3 * s + 2];
    const Lanes r2 = dx * dx + dy * dy + dz * dz;
    const LaneInts same = r2 == 0.0F;  // all bits, where the middles coincide
    Lanes root;
    square_root(same ? Lanes{} + 1.0F : r2, root);
    const Lanes inverse = 1.0F / root;
    Lanes c, n;
    exp_i(k * root, c, n);
    Lanes re = scale * inverse * c, im = scale * inverse * n;
    Lanes slope_re{}, slope_im{};
    if (slopes) {  // (ikR - 1) exp(ikR) / R^3
      const Lanes over = inverse * inverse;
      slope_re = over * (-(k * root) * im - re);
      slope_im = over * ((k * root) * re - im);
    }
    waves[s] = {same ? Lanes{} : re, same ? Lanes{} + scale * k : im};  // exp(ikR)/R without 1/R
    if (slopes) over_r[s] = {same ? Lanes{} : slope_re, same ? Lanes{} : slope_im};
  }
}

// What a block adds to a few columns, collected here so that each row of the matrix is visited once for all of them.
constexpr int kTile = 32;
struct Tile {
  Complexes entries[4][kTile];
};

[[gnu::always_inline]] inline void add_tile(const Block& block, const Tile& tile, int first, int last, int nodes,
                                            float* matrix) {
  for (int i = 0; i < 4; ++i) {
    const auto* const entries = reinterpret_cast<const float*>(tile.entries[i]);
    for (int lane = 0; lane < kLanes; ++lane) {
      float* const row = matrix + 2 * (static_cast<std::ptrdiff_t>(block.nodes[i][lane]) * nodes + first);
      for (int column = 0; column < last - first; ++column) {
        row[2 * column] += entries[2 * kLanes * column + lane];
        row[2 * column + 1] += entries[2 * kLanes * column + kLanes + lane];
      }
    }
  }
}

// The columns of the sources for a block's rows.
template <bool slopes>
[[gnu::always_inline]] inline void add_block(const Block& block, const Sources& sources, int nodes, float k,
                                             const float* coupling, Complexes* waves, Complexes* over_r, Tile& tile,
                                             float* matrix) {
  const float k2 = k * k;
  fill_kernels<slopes>(block, sources, k, waves, over_r);
  for (int column = sources.first; column < sources.last; ++column) {
    Complexes curl[3]{}, normal[3]{}, slope[4]{};
    const int own = column - sources.first;
    for (int at = sources.begin[own]; at < sources.begin[own + 1]; ++at) {
      const Share& share = sources.list[at];
      const Complexes wave = waves[share.side];
      for (int c = 0; c < 3; ++c) {
        curl[c].re += share.curl[c] * wave.re;
        curl[c].im += share.curl[c] * wave.im;
      }
      if (share.hat == 0) continue;
      for (int c = 0; c < 3; ++c) {
        normal[c].re += share.normal[c] * wave.re;
        normal[c].im += share.normal[c] * wave.im;
      }
      if (!slopes) continue;
      const Complexes steep = over_r[share.side];
      const float* const middle = sources.middles.data() + 3 * share.side;
      for (int c = 0; c < 3; ++c) {
        const Lanes along = (block.at[c] - middle[c]) * share.hat;
        slope[c].re += along * steep.re;
        slope[c].im += along * steep.im;
      }
    }
    Complexes common{};
    for (int c = 0; c < 3; ++c) {
      common.re += block.normal[c] * (k2 * normal[c].re);
      common.im += block.normal[c] * (k2 * normal[c].im);
      if (!slopes) continue;
      common.re += coupling[column] * block.normal[c] * slope[c].im;  // - i eta
      common.im -= coupling[column] * block.normal[c] * slope[c].re;
    }
    for (int i = 0; i < 4; ++i) {
      Complexes sum{};
      if (i < 2) sum = common;
      for (int c = 0; c < 3; ++c) {
        sum.re -= block.curl[i][c] * curl[c].re;
        sum.im -= block.curl[i][c] * curl[c].im;
      }
      tile.entries[i][own % kTile] = sum;
    }
    if (own % kTile == kTile - 1 || column == sources.last - 1) {
      add_tile(block, tile, column - own % kTile, column + 1, nodes, matrix);
    }
  }
}

RINGDOWN_CLONES
void add_columns(const std::vector<Block>& blocks, const Sources& sources, int nodes, float k, const float* coupling,
                 bool slopes, Complexes* waves, Complexes* over_r, Tile& tile, float* matrix) {
  for (const Block& block : blocks) {
    if (slopes) {
      add_block<true>(block, sources, nodes, k, coupling, waves, over_r, tile, matrix);
    } else {
      add_block<false>(block, sources, nodes, k, coupling, waves, over_r, tile, matrix);
    }
  }
}

void add_near(const NearIntegrals& near, double k, const std::vector<double>& coupling, ComplexMatrix& matrix) {
  const auto k2 = static_cast<float>(k * k);
  for (int row = 0; row < matrix.rows(); ++row) {
    for (int at = near.begin[row]; at < near.begin[row + 1]; ++at) {
      const NearIntegrals::Entry& entry = near.entries[at];
      const int column = near.columns[at];
      matrix(row, column) +=
          std::complex<float>(k2 * entry.normals - entry.curls, -static_cast<float>(coupling[column]) * entry.slopes);
    }
  }
}

void add_jump(const Panels& panels, const std::vector<double>& coupling, ComplexMatrix& matrix) {
  for (int t = 0; t < panels.triangle_count(); ++t) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const int row = panels.corners[t][i], column = panels.corners[t][j];
        const double hats = panels.areas[t] / (i == j ? 6 : 12);
        matrix(row, column) += std::complex<float>(0, static_cast<float>(0.5 * coupling[column] * hats));
      }
    }
  }
}

}  // namespace

// A few hundred nodes at a time are the place of y, and for these sixteen sides at a time that of x. First G between
// the sixteen and all sides around the nodes; then, node by node, its weighted sums over the node's sides, one for each
// component of the curl and of the normal; then what the sums give to the rows of the four nodes at each of the
// sixteen.
ComplexMatrix wave_matrix(const Panels& panels, const NearIntegrals& near, double wavenumber_rad_m,
                          const std::vector<double>& coupling) {
  const int nodes = panels.node_count();
  ComplexMatrix matrix = ComplexMatrix::Zero(nodes, nodes);
  const Eigen::Vector3d center = panels.nodes.colwise().mean().transpose();
  Panels centered = panels;  // single precision counts from the middle
  for (Side& side : centered.sides) side.middle -= center;
  std::vector<Block> blocks;
  for (int first = 0; first < centered.side_count(); first += kLanes) blocks.push_back(block_of(centered, first));
  const std::vector<float> eta(coupling.begin(), coupling.end());
  const bool slopes = std::any_of(eta.begin(), eta.end(), [](float value) { return value != 0; });
  Tile tile;
  std::vector<Complexes> waves, over_r;
  for (const Sources& sources : sources_of(centered)) {
    waves.resize(sources.middles.size() / 3);
    over_r.resize(waves.size());
    add_columns(blocks, sources, nodes, static_cast<float>(wavenumber_rad_m), eta.data(), slopes, waves.data(),
                over_r.data(), tile, reinterpret_cast<float*>(matrix.data()));
  }
  add_near(near, wavenumber_rad_m, coupling, matrix);
  add_jump(panels, coupling, matrix);
  return matrix;
}

}  // namespace ringdown::radiate
