#include "engine/radiate/wave_band.h"

#include "engine/base/in_parallel.h"
#include "engine/radiate/lanes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <span>

namespace ringdown::radiate {
namespace {

constexpr int kFewWavenumbers = 3;

// Nodes as three lists of coordinates, from their middle, whose lengths are made whole multiples of kLanes.
struct Places {
  std::array<std::vector<float>, 3> at;
};

Places places_of(const mesh::Points& nodes) {
  const Eigen::RowVector3d center = nodes.colwise().mean();
  Places places;
  for (int c = 0; c < 3; ++c) {
    auto& list = places.at[c];
    for (const double x : nodes.col(c)) list.push_back(static_cast<float>(x - center[c]));
    list.resize((list.size() + kLanes - 1) / kLanes * kLanes, 0.0F);
  }
  return places;
}

[[gnu::always_inline]] inline void load(Lanes& lanes, const float* from) { std::memcpy(&lanes, from, sizeof lanes); }

// Numbers that lie as pairs of real and imaginary part: eight of them in one Lanes, sixteen in two.
struct Pairs {
  Lanes low, high;
};

// Multiplies by cosine + i sine.
[[gnu::always_inline]] inline void turn_pairs(Pairs& pairs, const Lanes& cosine, const Lanes& sine) {
  constexpr int kPairsInLanes = kLanes / 2;
  const Lanes sign = {-1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1};
  Lanes turned[2];
  for (int half = 0; half < 2; ++half) {
    const Lanes& pair = half == 0 ? pairs.low : pairs.high;
    Lanes c, s;
    for (int p = 0; p < kPairsInLanes; ++p) {
      c[2 * p] = c[2 * p + 1] = cosine[kPairsInLanes * half + p];
      s[2 * p] = s[2 * p + 1] = sine[kPairsInLanes * half + p];
    }
    const Lanes swapped = __builtin_shufflevector(pair, pair, 1, 0, 3, 2, 5, 4, 7, 6, 9, 8, 11, 10, 13, 12, 15, 14);
    turned[half] = pair * c + swapped * (sign * s);
  }
  pairs = {turned[0], turned[1]};
}

// One row of a sum of three matrices, turned by exp(i k R). `rows` may be `out`.
RINGDOWN_CLONES
void turn_row(const Places& places, int row, int nodes, float k, const std::array<const float*, 3>& rows,
              const std::array<float, 3>& weights, float* out) {
  const float x = places.at[0][row], y = places.at[1][row], z = places.at[2][row];
  const std::size_t pair = 2 * sizeof(float);
  for (int first = 0; first < nodes; first += kLanes) {
    Lanes dx, dy, dz, r, cosine, sine;
    load(dx, places.at[0].data() + first);
    load(dy, places.at[1].data() + first);
    load(dz, places.at[2].data() + first);
    dx -= x;
    dy -= y;
    dz -= z;
    square_root(dx * dx + dy * dy + dz * dz, r);
    exp_i(k * r, cosine, sine);
    const int count = std::min(kLanes, nodes - first);
    Pairs sum{};
    for (int n = 0; n < 3; ++n) {
      if (weights[n] == 0) continue;
      float own[2 * kLanes]{};
      std::memcpy(own, rows[n] + 2 * first, count * pair);
      Pairs at;
      load(at.low, own);
      load(at.high, own + kLanes);
      sum.low += weights[n] * at.low;
      sum.high += weights[n] * at.high;
    }
    turn_pairs(sum, cosine, sine);
    std::memcpy(out + 2 * first, &sum, count * pair);
  }
}

const float* row_of(const ComplexMatrix& matrix, int row) {
  return reinterpret_cast<const float*>(matrix.data() + static_cast<std::ptrdiff_t>(row) * matrix.cols());
}
float* row_of(ComplexMatrix& matrix, int row) {
  return reinterpret_cast<float*>(matrix.data() + static_cast<std::ptrdiff_t>(row) * matrix.cols());
}

}  // namespace

// Three matrices at Chebyshev's points of the band.
WaveBand::WaveBand(const Skin& skin, double lowest_rad_m, double highest_rad_m, int wavenumbers, int threads)
    : skin_(skin), middle_rad_m_((lowest_rad_m + highest_rad_m) / 2) {
  coupling_ = coupling_of(skin, middle_rad_m_);
  if (wavenumbers <= kFewWavenumbers || !(highest_rad_m > lowest_rad_m)) return;
  const double half = (highest_rad_m - lowest_rad_m) / 2 * std::sqrt(3.0) / 2;
  wavenumbers_ = {middle_rad_m_ - half, middle_rad_m_, middle_rad_m_ + half};
  const Places places = places_of(skin.panels.nodes);
  const int nodes = skin.panels.node_count();
  for (int n = 0; n < 3; ++n) {
    ComplexMatrix& matrix = matrices_[n];
    wave_matrix(skin.panels, skin.near, wavenumbers_[n], coupling_, matrix, threads);
    if (n == 1) continue;
    in_parallel(threads, [&](int thread) {
      for (int row = thread; row < nodes; row += threads) {
        float* const own = row_of(matrix, row);
        turn_row(places, row, nodes, static_cast<float>(middle_rad_m_ - wavenumbers_[n]), {own, own, own}, {1, 0, 0},
                 own);
      }
    });
  }
}

void WaveBand::matrix_at(double wavenumber_rad_m, ComplexMatrix& matrix) const {
  if (matrices_[0].size() == 0) {
    wave_matrix(skin_.panels, skin_.near, wavenumber_rad_m, coupling_, matrix);
    return;
  }
  std::array<float, 3> weights{};
  for (int n = 0; n < 3; ++n) {
    double weight = 1;
    for (int other = 0; other < 3; ++other) {
      if (other == n) continue;
      weight *= (wavenumber_rad_m - wavenumbers_[other]) / (wavenumbers_[n] - wavenumbers_[other]);
    }
    weights[n] = static_cast<float>(weight);
  }
  const Places places = places_of(skin_.panels.nodes);
  const int nodes = skin_.panels.node_count();
  matrix.resize(nodes, nodes);
  for (int row = 0; row < nodes; ++row) {
    turn_row(places, row, nodes, static_cast<float>(wavenumber_rad_m - middle_rad_m_),
             {row_of(matrices_[0], row), row_of(matrices_[1], row), row_of(matrices_[2], row)}, weights,
             row_of(matrix, row));
  }
}

}  // namespace ringdown::radiate
