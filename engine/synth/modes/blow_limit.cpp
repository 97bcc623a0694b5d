#include "engine/synth/modes/blow_limit.h"

#include "engine/synth/modes/glide_reach.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace ringdown::synth {
namespace {

using Row = std::array<float, kMaxGlidingModes>;

// x0 of every mode for these |z|^2.
void detune(const GlideMatrix& matrix, const float* squares, Row& x0) REALTIME {
  Row reached;
  for (std::size_t l = 0; l < matrix.columns.size(); ++l) reached[l] = synth::reached(matrix, l, squares[l]);
  for (std::size_t first = 0; first < matrix.columns.size(); first += kModePadding) {
    const std::array<float, kModePadding> some = matrix.detuned(first / kModePadding, reached.data());
    const std::size_t count = std::min(kModePadding, matrix.columns.size() - first);
    std::copy_n(some.data(), count, x0.data() + first);
  }
}

}  // namespace

double blow_limit(const GlideMatrix& matrix, const float* squares, const double* amplitudes) REALTIME {
  constexpr double kMax = (kMaxThicknesses / kCrest) * (kMaxThicknesses / kCrest);
  const std::size_t n = matrix.columns.size();
  const float* const bend = matrix.bend.data();
  Row blow;
  double without_stiffness = 0;
  for (std::size_t m = 0; m < n; ++m) {
    const double a = amplitudes[matrix.columns[m]];
    blow[m] = static_cast<float>(a * a);
    without_stiffness += static_cast<double>(bend[m] * (squares[m] + blow[m]));
  }
  if (!(without_stiffness > kMax)) return 1;
  Row rings, struck;
  detune(matrix, squares, rings);
  detune(matrix, blow.data(), struck);
  const auto bends_too_far = [&](double share) REALTIME {
    double sum = 0;
    for (std::size_t m = 0; m < n; ++m) {
      const double s = share * share, z2 = double{squares[m]} + s * double{blow[m]};
      sum += double{bend[m]} * z2 / (1 + stiffened(double{rings[m]} + s * double{struck[m]}));
    }
    return sum > kMax;
  };
  if (!bends_too_far(1)) return 1;
  double low = 0, high = 1;
  constexpr int kHalvings = 20;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (bends_too_far(middle) ? high : low) = middle;
  }
  return low;
}

}  // namespace ringdown::synth
