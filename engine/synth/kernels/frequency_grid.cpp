#include "engine/synth/kernels/frequency_grid.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace ringdown::synth {
namespace {

constexpr double kPi = std::numbers::pi;
// Kaiser's parameter: of all, it leaves the least of what B cannot reach, by a search to three digits.
constexpr double kKaiser = 18.4;
constexpr std::size_t kHalf = kGridReach / 2;
using Half = std::array<double, kHalf>;

double time_of(std::size_t frame) { return (static_cast<double>(frame) - kMomentMiddle) / kMomentScale; }

// Returns by how much line n of a band lies above the middle of the band [radians per unit of t].
double detuning(std::size_t n) {
  return (static_cast<double>(n) - 0.5 * static_cast<double>(kGridReach - 1)) * kPi / 2;
}

// One over the transform of Kaiser's window of kGridReach lines.
double kaiser(double t) {
  const double reach = 0.25 * kPi * static_cast<double>(kGridReach) * t;
  const double x = std::sqrt(kKaiser * kKaiser - reach * reach);
  return x / std::sinh(x) * std::sinh(kKaiser) / kKaiser;
}

Half solve(std::array<Half, kHalf> matrix, Half right) {  // by Gauss; the matrix is positive definite
  for (std::size_t i = 0; i < kHalf; ++i) {
    for (std::size_t row = 0; row < kHalf; ++row) {
      if (row == i) continue;
      const double factor = matrix[row][i] / matrix[i][i];
      for (std::size_t c = i; c < kHalf; ++c) matrix[row][c] -= factor * matrix[i][c];
      right[row] -= factor * right[i];
    }
  }
  for (std::size_t i = 0; i < kHalf; ++i) right[i] /= matrix[i][i];
  return right;
}

// Without the decay about which they are expanded, the shapes q_p are even or odd in t, like p. So lines come in pairs,
// as cosines or sines, and least squares fit these to the shape.
Half fit(std::size_t p) {
  std::array<Half, kHalf> matrix{};
  Half right{};
  for (std::size_t j = 0; j < kChunkFrames; ++j) {
    const double t = time_of(j), shape = moment_shapes(t)[p] * std::exp(kMomentDecay * t);
    Half pair;
    for (std::size_t n = 0; n < kHalf; ++n) {
      const double phase = detuning(kHalf + n) * t;
      pair[n] = 2 * kaiser(t) * (p % 2 == 0 ? std::cos(phase) : std::sin(phase));
    }
    for (std::size_t a = 0; a < kHalf; ++a) {
      for (std::size_t b = 0; b < kHalf; ++b) matrix[a][b] += pair[a] * pair[b];
      right[a] += pair[a] * shape;
    }
  }
  return solve(matrix, right);
}

}  // namespace

FrequencyGrid::FrequencyGrid() {
  for (std::size_t j = 0; j < kChunkFrames; ++j) {
    psi[j] = kaiser(time_of(j)) * std::exp(-kMomentDecay * time_of(j));
  }
  for (std::size_t p = 0; p < kMoments; ++p) {
    const Half pairs = fit(p);
    for (std::size_t n = 0; n < kHalf; ++n) {
      const std::complex<double> above = p % 2 == 0 ? pairs[n] : std::complex<double>(0, -pairs[n]);
      spread[p][kHalf + n] = above;
      spread[p][kHalf - 1 - n] = std::conj(above);
    }
    for (std::size_t n = 0; n < kGridReach; ++n) {
      spread[p][n] *= std::polar(1.0, -detuning(n) * kMomentMiddle / kMomentScale);
    }
  }
}

const FrequencyGrid& frequency_grid() {
  static const FrequencyGrid grid;
  return grid;
}

std::array<float, 2 * kGridReach> grid_weights(std::complex<double> s) {
  const std::array<std::complex<double>, kMoments> weights = exact_moment_weights(s);
  std::array<float, 2 * kGridReach> lines{};
  for (std::size_t n = 0; n < kGridReach; ++n) {
    std::complex<double> sum = 0;
    for (std::size_t p = 0; p < kMoments; ++p) sum += weights[p] * frequency_grid().spread[p][n];
    const std::size_t place = (band_of(s) + n) % kGridReach;
    lines[place] = static_cast<float>(sum.real());
    lines[kGridReach + place] = static_cast<float>(sum.imag());
  }
  return lines;
}

}  // namespace ringdown::synth
