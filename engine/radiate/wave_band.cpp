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

// Nodes as three lists of coordinates, relative to their middle, padded to a multiple of kLanes.
struct Places {
  std::array<std::vector<float>, 3> at;
};

// The nodes of an image.
Places places_of(const mesh::Points& nodes, int mirrors, int image) {
  Eigen::RowVector3d center = nodes.colwise().mean();
  center.head(mirrors).setZero();
  Places places;
  for (int c = 0; c < 3; ++c) {
    auto& list = places.at[c];
    const double sign = (image >> c & 1) != 0 ? -1 : 1;
    for (const double x : nodes.col(c)) list.push_back(static_cast<float>(sign * (x - center[c])));
    list.resize((list.size() + kLanes - 1) / kLanes * kLanes, 0.0F);
  }
  return places;
}

std::vector<Places> images_of(const Skin& skin) {
  std::vector<Places> images;
  for (int image = 0; image < skin.panels.image_count(); ++image) {
    images.push_back(places_of(skin.panels.nodes, skin.panels.mirrors, image));
  }
  return images;
}

[[gnu::always_inline]] inline void load(Lanes& lanes, const float* from) { std::memcpy(&lanes, from, sizeof lanes); }

// Sixteen complex numbers, stored as pairs of real and imaginary part, eight in each Lanes.
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

// Computes one row of a sum of three matrices, times exp(i k R); R is the distance of `places` from `from`. `rows` may
// be `out`.
RINGDOWN_CLONES
void turn_row(const std::array<float, 3>& from, const Places& places, int nodes, float k,
              const std::array<const float*, 3>& rows, const std::array<float, 3>& weights, float* out) {
  const auto [x, y, z] = from;
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

std::array<float, 3> place(const Places& places, int node) {
  return {places.at[0][node], places.at[1][node], places.at[2][node]};
}

// Converts one matrix per image to one per class: for each plane, the sum and the difference of the images on its two
// sides.
class ClassSums {
 public:
  explicit ClassSums(const Skin& skin)
      : nodes_(skin.panels.node_count()), mirrors_(skin.panels.mirrors), zero_(skin.zero_nodes) {
    for (const std::vector<int>& nodes : zero_) {
      std::vector<bool>& is_zero = is_zero_.emplace_back(nodes_, false);
      for (const int n : nodes) is_zero[n] = true;
    }
  }

  void add_row(int row, std::vector<ComplexMatrix>& matrices) const {
    for (int axis = 0; axis < mirrors_; ++axis) {
      for (int image = 0; image < 1 << mirrors_; ++image) {
        if ((image >> axis & 1) == 0)
          add_and_subtract(row_of(matrices[image], row), row_of(matrices[image | 1 << axis], row));
      }
    }
    for (std::size_t c = 1; c < zero_.size(); ++c) {
      const std::complex<float> diagonal = matrices[c](row, row);
      if (is_zero_[c][row]) matrices[c].row(row).setZero();
      for (const int n : zero_[c]) matrices[c](row, n) = 0;
      if (is_zero_[c][row]) matrices[c](row, row) = diagonal;
    }
  }

 private:
  void add_and_subtract(float* even, float* odd) const {
    for (int i = 0; i < 2 * nodes_; ++i) {
      const float sum = even[i] + odd[i], difference = even[i] - odd[i];
      even[i] = sum;
      odd[i] = difference;
    }
  }

  const int nodes_, mirrors_;
  const std::vector<std::vector<int>>& zero_;  // nodes, for each class
  std::vector<std::vector<bool>> is_zero_;
};

void image_matrices(const Skin& skin, double wavenumber_rad_m, const std::vector<double>& coupling,
                    std::vector<ComplexMatrix>& matrices, int threads) {
  matrices.resize(skin.near.size());
  for (int image = 0; image < skin.panels.image_count(); ++image) {
    wave_matrix(skin.panels, image, skin.near[image], wavenumber_rad_m, coupling, matrices[image], threads);
  }
}

}  // namespace

void class_matrices(const Skin& skin, double wavenumber_rad_m, const std::vector<double>& coupling,
                    ClassMatrices& matrices, int threads) {
  image_matrices(skin, wavenumber_rad_m, coupling, matrices, threads);
  const ClassSums sums(skin);
  for (int row = 0; row < skin.panels.node_count(); ++row) sums.add_row(row, matrices);
}

// Prepares the matrices at the three Chebyshev points of the band.
WaveBand::WaveBand(const Skin& skin, double lowest_rad_m, double highest_rad_m, int wavenumbers, int threads)
    : skin_(skin), middle_rad_m_((lowest_rad_m + highest_rad_m) / 2) {
  coupling_ = coupling_of(skin, middle_rad_m_);
  if (wavenumbers <= kFewWavenumbers || !(highest_rad_m > lowest_rad_m)) return;
  const double half = (highest_rad_m - lowest_rad_m) / 2 * std::sqrt(3.0) / 2;
  wavenumbers_ = {middle_rad_m_ - half, middle_rad_m_, middle_rad_m_ + half};
  const std::vector<Places> images = images_of(skin);
  const int nodes = skin.panels.node_count();
  for (int n = 0; n < 3; ++n) {
    image_matrices(skin, wavenumbers_[n], coupling_, matrices_[n], threads);
    if (n == 1) continue;
    in_parallel(threads, [&](int thread) {
      for (int row = thread; row < nodes; row += threads) {
        for (std::size_t image = 0; image < images.size(); ++image) {
          float* const own = row_of(matrices_[n][image], row);
          turn_row(place(images[0], row), images[image], nodes, static_cast<float>(middle_rad_m_ - wavenumbers_[n]),
                   {own, own, own}, {1, 0, 0}, own);
        }
      }
    });
  }
}

void WaveBand::matrices_at(double wavenumber_rad_m, ClassMatrices& matrices) const {
  if (matrices_[0].empty()) {
    class_matrices(skin_, wavenumber_rad_m, coupling_, matrices);
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
  const std::vector<Places> images = images_of(skin_);
  const ClassSums sums(skin_);
  const int nodes = skin_.panels.node_count();
  matrices.resize(images.size());
  for (ComplexMatrix& matrix : matrices) matrix.resize(nodes, nodes);
  for (int row = 0; row < nodes; ++row) {
    for (std::size_t image = 0; image < images.size(); ++image) {
      turn_row(place(images[0], row), images[image], nodes, static_cast<float>(wavenumber_rad_m - middle_rad_m_),
               {row_of(matrices_[0][image], row), row_of(matrices_[1][image], row), row_of(matrices_[2][image], row)},
               weights, row_of(matrices[image], row));
    }
    sums.add_row(row, matrices);
  }
}

}  // namespace ringdown::radiate
