// The inner loop of modes that are coupled and exchange energy sample by sample (coupled_modes.h). One source, compiled
// for every instruction set that Highway knows.
#pragma once

#include "engine/base/realtime.h"

#include <cstddef>

namespace ringdown::synth {

inline constexpr std::size_t kCoupledPadding = 16;  // arrays of modes are padded with zeros to a multiple of this

inline constexpr std::size_t kMaxCoupledStride = 304;

// K functions of M modes, M padded to `stride`; 64-byte aligned.
struct CoupledArrays {
  const float* bending = nullptr;  // K x stride x stride: H^k, symmetric
  const float* curving = nullptr;  // K x stride: g
  std::size_t functions = 0;
  std::size_t stride = 0;  // a multiple of kCoupledPadding, at most kMaxCoupledStride; up to 64 is fast
};

// For displacements q (`stride` floats): the gradient of V = sum over k of [ (g_k . q) t_k + 1/2 t_k^2 ],
// t_k = q^T H^k q, into `gradient`; returns V. [audio]
double coupled_forces(const CoupledArrays& terms, const float* q, float* gradient) REALTIME;

}  // namespace ringdown::synth
