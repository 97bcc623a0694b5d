#include <hwy/highway.h>

#include "engine/synth/kernels/coupled_kernel.h"

// y = H q is summed column by column, q_j times row j of H, so that no sum runs across lanes and H is read once, in
// order. All of y stays in registers.
HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using FloatTag = hn::CappedTag<float, 16>;

template <std::size_t kVectors>
double forces_of(const CoupledArrays& terms, const float* HWY_RESTRICT q, float* HWY_RESTRICT gradient) {
  const FloatTag tag;
  constexpr std::size_t kLanes = hn::MaxLanes(FloatTag());
  hn::Vec<FloatTag> place[kVectors], sum[kVectors];
  for (std::size_t v = 0; v < kVectors; ++v) {
    place[v] = hn::Load(tag, q + v * kLanes);
    sum[v] = hn::Zero(tag);
  }
  double energy = 0;
  const float* HWY_RESTRICT row = terms.bending;
  for (std::size_t k = 0; k < terms.functions; ++k) {
    hn::Vec<FloatTag> even[kVectors], odd[kVectors];
    for (std::size_t v = 0; v < kVectors; ++v) even[v] = odd[v] = hn::Zero(tag);
    for (std::size_t j = 0; j < terms.stride; j += 2, row += 2 * terms.stride) {
      const auto first = hn::Set(tag, q[j]), second = hn::Set(tag, q[j + 1]);
      for (std::size_t v = 0; v < kVectors; ++v) {
        even[v] = hn::MulAdd(first, hn::Load(tag, row + v * kLanes), even[v]);
        odd[v] = hn::MulAdd(second, hn::Load(tag, row + terms.stride + v * kLanes), odd[v]);
      }
    }
    const float* const curving = terms.curving + k * terms.stride;
    auto quadratic = hn::Zero(tag), linear = hn::Zero(tag);
    for (std::size_t v = 0; v < kVectors; ++v) {
      even[v] = hn::Add(even[v], odd[v]);
      quadratic = hn::MulAdd(even[v], place[v], quadratic);
      linear = hn::MulAdd(hn::Load(tag, curving + v * kLanes), place[v], linear);
    }
    const float t = hn::GetLane(hn::SumOfLanes(tag, quadratic)), g = hn::GetLane(hn::SumOfLanes(tag, linear));
    energy += static_cast<double>(t) * (0.5 * static_cast<double>(t) + static_cast<double>(g));
    const auto by_bending = hn::Set(tag, 2 * (t + g)), by_curving = hn::Set(tag, t);
    for (std::size_t v = 0; v < kVectors; ++v) {
      sum[v] = hn::MulAdd(by_bending, even[v], sum[v]);
      sum[v] = hn::MulAdd(by_curving, hn::Load(tag, curving + v * kLanes), sum[v]);
    }
  }
  for (std::size_t v = 0; v < kVectors; ++v) hn::Store(sum[v], tag, gradient + v * kLanes);
  return energy;
}

// For more modes than registers hold: y stays in the L1 cache, and four rows of H are added to it at a time.
double forces_of_many(const CoupledArrays& terms, const float* HWY_RESTRICT q, float* HWY_RESTRICT gradient) {
  const FloatTag tag;
  constexpr std::size_t kLanes = hn::MaxLanes(FloatTag());
  const std::size_t n = terms.stride;
  alignas(64) float y[kMaxCoupledStride];
  for (std::size_t i = 0; i < n; ++i) gradient[i] = 0;
  double energy = 0;
  const float* HWY_RESTRICT row = terms.bending;
  for (std::size_t k = 0; k < terms.functions; ++k) {
    for (std::size_t i = 0; i < n; ++i) y[i] = 0;
    for (std::size_t j = 0; j < n; j += 4, row += 4 * n) {
      const auto q0 = hn::Set(tag, q[j]), q1 = hn::Set(tag, q[j + 1]);
      const auto q2 = hn::Set(tag, q[j + 2]), q3 = hn::Set(tag, q[j + 3]);
      for (std::size_t i = 0; i < n; i += kLanes) {
        auto sum = hn::MulAdd(q0, hn::Load(tag, row + i), hn::Load(tag, y + i));
        sum = hn::MulAdd(q1, hn::Load(tag, row + n + i), sum);
        sum = hn::MulAdd(q2, hn::Load(tag, row + 2 * n + i), sum);
        sum = hn::MulAdd(q3, hn::Load(tag, row + 3 * n + i), sum);
        hn::Store(sum, tag, y + i);
      }
    }
    const float* const curving = terms.curving + k * n;
    auto quadratic = hn::Zero(tag), linear = hn::Zero(tag);
    for (std::size_t i = 0; i < n; i += kLanes) {
      quadratic = hn::MulAdd(hn::Load(tag, y + i), hn::Load(tag, q + i), quadratic);
      linear = hn::MulAdd(hn::Load(tag, curving + i), hn::Load(tag, q + i), linear);
    }
    const float t = hn::GetLane(hn::SumOfLanes(tag, quadratic)), g = hn::GetLane(hn::SumOfLanes(tag, linear));
    energy += static_cast<double>(t) * (0.5 * static_cast<double>(t) + static_cast<double>(g));
    const auto by_bending = hn::Set(tag, 2 * (t + g)), by_curving = hn::Set(tag, t);
    for (std::size_t i = 0; i < n; i += kLanes) {
      auto sum = hn::MulAdd(by_bending, hn::Load(tag, y + i), hn::Load(tag, gradient + i));
      sum = hn::MulAdd(by_curving, hn::Load(tag, curving + i), sum);
      hn::Store(sum, tag, gradient + i);
    }
  }
  return energy;
}

double coupled_forces_here(const CoupledArrays& terms, const float* q, float* gradient) {
  constexpr std::size_t kPerPadding = kCoupledPadding / hn::MaxLanes(FloatTag());
  switch (terms.stride / kCoupledPadding) {
    case 1:
      return forces_of<kPerPadding>(terms, q, gradient);
    case 2:
      return forces_of<2 * kPerPadding>(terms, q, gradient);
    case 3:
      return forces_of<3 * kPerPadding>(terms, q, gradient);
    case 4:
      return forces_of<4 * kPerPadding>(terms, q, gradient);
    default:
      return forces_of_many(terms, q, gradient);
  }
}

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ringdown::synth {

HWY_EXPORT(coupled_forces_here);

// Highway's dispatch reads an atomic, and indexes a table of functions, all of them in this file.
TRUST_REALTIME_BEGIN
double coupled_forces(const CoupledArrays& terms, const float* q, float* gradient) REALTIME {
  return HWY_DYNAMIC_DISPATCH(coupled_forces_here)(terms, q, gradient);
}
TRUST_REALTIME_END

}  // namespace ringdown::synth
#endif
