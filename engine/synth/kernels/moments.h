// Computes many modes at once: a chunk of their sum from a few moments per band of frequency, and one short transform.
//
// A chunk is a window of kChunkFrames frames, with t in [-1, 1] across it, and frequencies are divided into kBands
// bands of width (sample rate) / (2 kChunkFrames), band k centred at w_k. A mode is exp(s j) with s = -d + i omega per
// frame; its offset from the band's centre is small: delta = (s - i w_k) kChunkFrames / 2, and
//   exp(delta t) = sum over p < kMoments of (delta + kDecay)^p q_p(t),
// with real q_p(t) common to all modes: the truncated Chebyshev expansion of exp, in powers. So all modes of a band
// reduce to kMoments sums of z (delta + kDecay)^p, the moments, and the chunk is kMoments inverse Fourier transforms of
// 2 kChunkFrames, each times its q_p. The cost of a mode does not depend on the chunk's length. The truncation error is
// below 1.1e-6 of a mode's amplitude (-119 dB) for modes that takes_moments() accepts, 3e-8 (-150 dB) in the middle.
//
// After an idea in the literature on non-uniform transforms: Anderson & Dahleh, SIAM J. Sci. Comput. 17, 1996.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/kernels/mode_kernel.h"

#include <array>
#include <complex>
#include <cstdint>
#include <span>

namespace ringdown::synth {

inline constexpr std::size_t kMoments = 8;
inline constexpr std::size_t kBands = kChunkFrames + 1;

// Frame j of a chunk is at t = (j - kMomentMiddle) / kMomentScale.
inline constexpr double kMomentScale = 0.5 * static_cast<double>(kChunkFrames);
inline constexpr double kMomentMiddle = kMomentScale - 0.5;
// Decay over half a window about which the exponential is expanded: modes with up to twice this decay take moments.
inline constexpr double kMomentDecay = 0.2;

// Returns whether a mode exp(s n) decays slowly enough, and lies below Nyquist. [any]
bool takes_moments(std::complex<double> s);

// Return the band of a mode, and the weights by which its z is multiplied to make moments: kMoments real parts, then
// imaginary parts. [any]
std::uint16_t band_of(std::complex<double> s);
std::array<float, 2 * kMoments> moment_weights(std::complex<double> s);
std::array<std::complex<double>, kMoments> exact_moment_weights(std::complex<double> s);
// Returns q_p(t) for each p. [any]
std::array<double, kMoments> moment_shapes(double t);

// The moments of one output: kBands times kMoments real and kMoments imaginary parts.
struct alignas(64) MomentSums {
  std::array<float, kBands * 2 * kMoments> of{};
};

// Data of modes for moments, in addition to ModeArrays.
struct MomentArrays {
  const std::uint16_t* band = nullptr;  // ascending
  const float* weights = nullptr;       // 2 kMoments for each mode, 64-byte aligned
  const float* lines = nullptr;         // 2 kGridReach for each mode (grid_weights()), 64-byte aligned; may be null
};

// Number of lines to which a mode of one band is added (frequency_grid.h).
inline constexpr std::size_t kGridReach = 8;

// Lines in place of moments: kGridNumbers of them as the destination, 64-byte aligned, and the factors from moments to
// the lines of their band: for the real part of each moment, and for the imaginary part, 2 kGridReach numbers each.
struct MomentGrid {
  float* lines = nullptr;
  const float* spread = nullptr;
};

// An output and the gain of the modes there. For modes with a Hearing (ModeArrays::hearing) the gain may move in a
// straight line, by `slope` from the middle of the window to its end.
struct MomentTarget {
  MomentSums* sums = nullptr;
  float gain = 0;
  float slope = 0;
  // Not null: lines are wanted, at a gain of 1; this must be the only target of the call.
  const MomentGrid* grid = nullptr;
};

// A gain that moves in a straight line from the first frame of a chunk to the one after its last.
struct Fade {
  float from = 1, to = 1;
  [[nodiscard]] bool none() const REALTIME { return from == 1 && to == 1; }
};

// Adds the moments of the active groups to each target and moves their states on by `frames` <= kChunkFrames; groups
// that fall below the floor leave the list. Returns false if the energy of a state is above `limits.max` or NaN: the
// remaining groups are then not processed, and the wrong values are not added. A fade multiplies the sound of these
// modes (not their states); the truncation error is then 20 dB larger. [audio]
bool add_moments(const ModeArrays& modes, const MomentArrays& moments, ActiveGroups& active, std::size_t frames,
                 const EnergyLimits& limits, std::span<const MomentTarget> targets, Fade fade = {}) REALTIME;
// Does this for modes whose `hearing` is set; called by add_moments().
bool add_heard_moments(const ModeArrays& modes, const MomentArrays& moments, ActiveGroups& active, std::size_t frames,
                       const EnergyLimits& limits, std::span<const MomentTarget> targets, Fade fade) REALTIME;

// The transform of a chunk, sum over k of x_k exp(2 pi i j k / kPoints), for eight sequences at once. [audio, after
// construction]
class ChunkTransform {
 public:
  static constexpr std::size_t kPoints = 2 * kChunkFrames;
  ChunkTransform();
  // Transforms in place. Each point holds the eight sequences' numbers, 64-byte aligned. Only the first `frames` <=
  // kChunkFrames frames are computed; frame j is at point places()[j].
  void run(float* re, float* im, std::size_t frames) const REALTIME;
  [[nodiscard]] const std::uint16_t* places() const REALTIME { return places_.data(); }

 private:
  std::array<float, kPoints> cosine_, sine_;
  std::array<std::uint16_t, kChunkFrames> places_;
};

// Turns moments into samples. [audio, after construction]
class MomentSynthesis {
 public:
  MomentSynthesis();

  // Adds the first `frames` samples of two outputs. Uses up the sums: they are not zero afterwards.
  void add(const MomentSums& left, const MomentSums& right, double* out_left, double* out_right,
           std::size_t frames) REALTIME;

 private:
  static_assert(kMoments == 8, "one for each sequence of the transform");
  ChunkTransform transform_;
  alignas(64) std::array<float, kChunkFrames * kMoments> shape_;  // q_p at each frame
  alignas(64) std::array<float, ChunkTransform::kPoints * kMoments> re_, im_;
};

}  // namespace ringdown::synth
