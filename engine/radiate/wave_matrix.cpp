#include "engine/radiate/wave_matrix.h"

#include "engine/base/in_parallel.h"
#include "engine/radiate/lanes.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace ringdown::radiate {
namespace {

// A side's share for one node: the weights of the three components of the curl, and whether the node lies on the side.
// Otherwise the node's hat function is 0 on the side.
struct Share {
  int side;
  float curl[3];
  bool on_side;
};

// Consecutive nodes as points y, with the sides around them; few enough that their kernels stay in the cache.
struct Sources {
  struct Place {
    float at[3];
    float normal[3];  // the weights of the normal's components for the hat function of a node on the side
    float hat;        // the weight of the hat function alone
  };
  int first = 0, last = 0;    // range of nodes, `last` excluded
  std::vector<Place> places;  // places of the sides
  std::vector<int> begin;     // last - first + 1: first share of each node
  std::vector<Share> list;    // shares; their sides are positions in `places`
};
constexpr int kNodesOfSources = 192;

Sources::Place place_of(const Panels& panels, int number) {
  const Side& side = panels.sides[number];
  Sources::Place place{};
  for (int c = 0; c < 3; ++c) place.at[c] = static_cast<float>(side.middle[c]);
  for (const int triangle : side.triangles) {
    if (triangle < 0) continue;
    const double weight = panels.areas[triangle] / 6;  // a third of the area, where the hat function is 1/2
    for (int c = 0; c < 3; ++c) place.normal[c] += static_cast<float>(weight * panels.normals[triangle][c]);
    place.hat += static_cast<float>(weight);
  }
  return place;
}

Share share_of(const Panels& panels, int number, int position) {
  const Side& side = panels.sides[number];
  Share share{number, {}, position < 2};
  for (const int triangle : side.triangles) {
    if (triangle < 0) continue;
    const auto& corners = panels.corners[triangle];
    const auto at = std::find(corners.begin(), corners.end(), side.nodes[position]);
    if (at == corners.end()) continue;
    const Eigen::Vector3d curl = panels.areas[triangle] / 3 * panels.curls[triangle][at - corners.begin()];
    for (int c = 0; c < 3; ++c) share.curl[c] += static_cast<float>(curl[c]);
  }
  return share;
}

std::vector<Sources> sources_of(const Panels& panels) {
  std::vector<std::vector<std::pair<int, int>>> by_node(panels.node_count());  // side, node's position at it
  for (int s = 0; s < panels.side_count(); ++s) {
    for (int i = 0; i < 4; ++i) {
      if (panels.sides[s].nodes[i] >= 0) by_node[panels.sides[s].nodes[i]].emplace_back(s, i);
    }
  }
  std::vector<Sources> all;
  for (int first = 0; first < panels.node_count(); first += kNodesOfSources) {
    Sources sources{first, std::min(first + kNodesOfSources, panels.node_count()), {}, {}, {}};
    std::map<int, int> position;
    for (int node = first; node < sources.last; ++node) {
      sources.begin.push_back(static_cast<int>(sources.list.size()));
      for (const auto& [side, at] : by_node[node]) {
        const auto [found, fresh] = position.emplace(side, static_cast<int>(position.size()));
        if (fresh) sources.places.push_back(place_of(panels, side));
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

// Sixteen sides as points x; the last side is repeated, with weight 0, to fill the block.
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
    const Sources::Place place = place_of(panels, number);
    for (int c = 0; c < 3; ++c) {
      block.at[c][lane] = place.at[c];
      block.normal[c][lane] = real ? place.normal[c] : 0;
    }
    for (int i = 0; i < 4; ++i) {
      const Share share = share_of(panels, number, i);
      block.nodes[i][lane] = std::max(0, panels.sides[number].nodes[i]);  // missing: node 0, weight 0
      for (int c = 0; c < 3; ++c) block.curl[i][c][lane] = real ? share.curl[c] : 0;
    }
  }
  return block;
}

// The kernels of the integrals, between each of the block's sides and one of the sources'.
struct Kernels {
  Complexes wave;    // G
  Complexes normal;  // k^2 n(x).n(y) G
  Complexes slope;   // hat(y) dG/dn(x), with `slopes`
};

template <bool slopes>
[[gnu::always_inline]] inline void fill_kernels(const Block& block, const Sources& sources, float k, Kernels* kernels) {
  const float scale = static_cast<float>(0.25 / std::numbers::pi), k2 = k * k;
  const int sides = static_cast<int>(sources.places.size());
  for (int s = 0; s < sides; ++s) {
    const Sources::Place& place = sources.places[s];
    const Lanes dx = block.at[0] - place.at[0], dy = block.at[1] - place.at[1], dz = block.at[2] - place.at[2];
    const Lanes r2 = dx * dx + dy * dy + dz * dz;
    const LaneInts same = r2 == 0.0F;  // all bits set where the middles coincide
    Lanes root{};
    square_root(same ? Lanes{} + 1.0F : r2, root);
    const Lanes inverse = 1.0F / root;
    Lanes c, n;
    exp_i(k * root, c, n);
    Lanes re = scale * inverse * c, im = scale * inverse * n;
    Kernels& kernel = kernels[s];
    if (slopes) {  // (ikR - 1) exp(ikR) / R^3, times R.n(x), which is 0 where the middles coincide
      const Lanes along = dx * block.normal[0] + dy * block.normal[1] + dz * block.normal[2];
      const Lanes over = place.hat * inverse * inverse * along, kr = k * root;
      kernel.slope = {over * (-kr * im - re), over * (kr * re - im)};
    }
    re = same ? Lanes{} : re;
    im = same ? Lanes{} + scale * k : im;  // exp(ikR)/R without 1/R
    const Lanes across = k2 * (block.normal[0] * place.normal[0] + block.normal[1] * place.normal[1] +
                               block.normal[2] * place.normal[2]);
    kernel.wave = {re, im};
    kernel.normal = {across * re, across * im};
  }
}

// The sums of a block for a few columns, collected so that each row of the matrix is visited once for all of these
// columns.
struct Tile {
  Lanes re[4][kLanes], im[4][kLanes];
};

[[gnu::always_inline]] inline void add_tile(const Block& block, Tile& tile, int first, int last, int nodes,
                                            float* matrix) {
  for (int i = 0; i < 4; ++i) {
    transpose(tile.re[i]);
    transpose(tile.im[i]);
    for (int lane = 0; lane < kLanes; ++lane) {
      float* const row = matrix + 2 * (static_cast<std::ptrdiff_t>(block.nodes[i][lane]) * nodes + first);
      float pairs[2 * kLanes];
      for (int column = 0; column < kLanes; ++column) {
        pairs[2 * column] = tile.re[i][lane][column];
        pairs[2 * column + 1] = tile.im[i][lane][column];
      }
      if (last - first == kLanes) {
        for (int part = 0; part < 2 * kLanes; ++part) row[part] += pairs[part];
      } else {
        for (int part = 0; part < 2 * (last - first); ++part) row[part] += pairs[part];
      }
    }
  }
}

// Computes the columns of the sources for a block's rows.
template <bool slopes>
[[gnu::always_inline]] inline void add_block(const Block& block, const Sources& sources, int nodes, float k,
                                             const float* coupling, Kernels* kernels, Tile& tile, float* matrix) {
  fill_kernels<slopes>(block, sources, k, kernels);
  for (int column = sources.first; column < sources.last; ++column) {
    Complexes curl[3]{}, common{}, slope{};
    const int own = column - sources.first;
    for (int at = sources.begin[own]; at < sources.begin[own + 1]; ++at) {
      const Share& share = sources.list[at];
      const Kernels& kernel = kernels[share.side];
      for (int c = 0; c < 3; ++c) {
        curl[c].re += share.curl[c] * kernel.wave.re;
        curl[c].im += share.curl[c] * kernel.wave.im;
      }
      if (!share.on_side) continue;
      common.re += kernel.normal.re;
      common.im += kernel.normal.im;
      if (!slopes) continue;
      slope.re += kernel.slope.re;
      slope.im += kernel.slope.im;
    }
    if (slopes) {  // - i eta
      common.re += coupling[column] * slope.im;
      common.im -= coupling[column] * slope.re;
    }
    for (int i = 0; i < 4; ++i) {
      Complexes sum{};
      if (i < 2) sum = common;
      for (int c = 0; c < 3; ++c) {
        sum.re -= block.curl[i][c] * curl[c].re;
        sum.im -= block.curl[i][c] * curl[c].im;
      }
      tile.re[i][own % kLanes] = sum.re;
      tile.im[i][own % kLanes] = sum.im;
    }
    if (own % kLanes == kLanes - 1 || column == sources.last - 1) {
      add_tile(block, tile, column - own % kLanes, column + 1, nodes, matrix);
    }
  }
}

RINGDOWN_CLONES
void add_columns(const std::vector<Block>& blocks, const Sources& sources, int nodes, float k, const float* coupling,
                 bool slopes, Kernels* kernels, Tile& tile, float* matrix) {
  for (const Block& block : blocks) {
    if (slopes) {
      add_block<true>(block, sources, nodes, k, coupling, kernels, tile, matrix);
    } else {
      add_block<false>(block, sources, nodes, k, coupling, kernels, tile, matrix);
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

// A few hundred nodes at a time serve as y, and for these nodes, sixteen sides at a time serve as x. The first step
// computes G between the sixteen sides and all sides around the nodes. The second step computes, node by node, the
// weighted sums of G over the node's sides, one for each component of the curl and one for the normals. The third step
// adds the contributions of these sums to the rows of the four nodes at each of the sixteen sides, sixteen columns at a
// time.
void wave_matrix(const Panels& part, int image, const NearIntegrals& near, double wavenumber_rad_m,
                 const std::vector<double>& coupling, ComplexMatrix& matrix, int threads) {
  const int nodes = part.node_count();
  matrix.setZero(nodes, nodes);
  const Eigen::Vector3d mean = part.nodes.colwise().mean().transpose();
  const Eigen::Vector3d center = (mean + image_of(mean, image)) / 2;
  Panels centered = part, mirrored = image_of(part, image);  // single precision: relative to the middle
  for (Side& side : centered.sides) side.middle -= center;
  for (Side& side : mirrored.sides) side.middle -= center;
  std::vector<Block> blocks;
  for (int first = 0; first < centered.side_count(); first += kLanes) blocks.push_back(block_of(centered, first));
  const std::vector<float> eta(coupling.begin(), coupling.end());
  const bool slopes = std::any_of(eta.begin(), eta.end(), [](float value) { return value != 0; });
  const std::vector<Sources> all = sources_of(mirrored);
  std::atomic<std::size_t> next{0};
  in_parallel(threads, [&](int) {  // each thread writes to its own columns
    Tile tile;
    std::vector<Kernels> kernels;
    for (std::size_t s = next++; s < all.size(); s = next++) {
      kernels.resize(all[s].places.size());
      add_columns(blocks, all[s], nodes, static_cast<float>(wavenumber_rad_m), eta.data(), slopes, kernels.data(), tile,
                  reinterpret_cast<float*>(matrix.data()));
    }
  });
  add_near(near, wavenumber_rad_m, coupling, matrix);
  if (image == 0) add_jump(part, coupling, matrix);
}

}  // namespace ringdown::radiate
