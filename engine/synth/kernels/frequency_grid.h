// The modes of a chunk on a grid of frequencies. This takes fewer numbers than moments, which helps if they are added
// to many channels.
//
// The grid has kGridLines frequencies, (i - 3.5) pi / kChunkFrames per frame. To -137 dB, the shapes of a band's
// moments (moments.h) are
//   q_p(t) = psi(t) sum over n < kGridReach of B(p, n) exp(i (n - 3.5) pi/2 t),
// with one psi for all p. So a mode of band k is represented by its amplitudes at lines k ... k + kGridReach - 1, and
// one transform, times psi, turns the sum of all modes into samples. This requires a psi with a narrow transform, such
// as Kaiser's window in non-uniform Fourier transforms (Fessler & Sutton, IEEE Trans. Signal Process. 51, 2003).
#pragma once

#include "engine/synth/kernels/moments.h"

#include <array>
#include <complex>
#include <cstddef>

namespace ringdown::synth {

inline constexpr std::size_t kGridLines = (kBands + kGridReach - 1 + 7) / 8 * 8;
// Memory layout of lines: the real parts of kGridReach lines, their imaginary parts, then those of the next lines.
inline constexpr std::size_t kGridNumbers = 2 * kGridLines;

struct FrequencyGrid {
  FrequencyGrid();                         // [worker]
  std::array<double, kChunkFrames> psi{};  // at each frame
  // B(p, n), rotated so that lines follow exp(i frequency j) in frame j.
  std::array<std::array<std::complex<double>, kGridReach>, kMoments> spread{};
};
const FrequencyGrid& frequency_grid();  // [worker]

// Returns the factors that turn a mode's z into lines: line i has its real part at index i modulo kGridReach, and its
// imaginary part kGridReach later. [worker]
std::array<float, 2 * kGridReach> grid_weights(std::complex<double> s);

}  // namespace ringdown::synth
