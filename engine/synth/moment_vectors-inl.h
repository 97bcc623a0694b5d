// Vectors of moments, for the kernels: included once per instruction set, after Highway (its -inl.h convention).
#if defined(RINGDOWN_MOMENT_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RINGDOWN_MOMENT_VECTORS_INL_H
#undef RINGDOWN_MOMENT_VECTORS_INL_H
#else
#define RINGDOWN_MOMENT_VECTORS_INL_H
#endif

#include "engine/synth/moments.h"

#include "engine/synth/mode_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// kCount numbers, in as few vectors as the instruction set allows.
template <std::size_t kCount>
struct Numbers {
  using Tag = hn::CappedTag<float, kCount>;
  static constexpr std::size_t kLanes = hn::MaxLanes(Tag()), kVectors = kCount / kLanes;
  hn::Vec<Tag> part[kVectors];

  HWY_INLINE Numbers() {}
  template <class Do>
  HWY_INLINE static Numbers make(Do&& act) {
    Numbers result;
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) result.part[v] = act(v);
    return result;
  }
  HWY_INLINE static Numbers load(const float* from) {
    return make([from](std::size_t v) HWY_ATTR { return hn::Load(Tag(), from + v * kLanes); });
  }
  HWY_INLINE static Numbers all(float value) {
    return make([value](std::size_t) HWY_ATTR { return hn::Set(Tag(), value); });
  }
  HWY_INLINE void store(float* to) const {
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) hn::Store(part[v], Tag(), to + v * kLanes);
  }
  [[nodiscard]] HWY_INLINE float sum() const {
    auto total = part[0];
    RINGDOWN_UNROLL
    for (std::size_t v = 1; v < kVectors; ++v) total = hn::Add(total, part[v]);
    return hn::GetLane(hn::SumOfLanes(Tag(), total));
  }
  // The second half first.
  [[nodiscard]] HWY_INLINE Numbers turned() const {
#if HWY_TARGET != HWY_SCALAR  // which has no vectors to turn
    if constexpr (kVectors == 1) {
      return make([this](std::size_t) HWY_ATTR { return hn::ConcatLowerUpper(Tag(), part[0], part[0]); });
    }
#endif
    return make([this](std::size_t v) HWY_ATTR { return part[(v + kVectors / 2) % kVectors]; });
  }
  // Element i of each half of kMoments times i, and moved up from i - 1: as exp(delta t) is a sum of x^p q_p(t), t
  // exp(delta t) is one of p x^(p-1) q_p(t), so this multiplies what the moments stand for with t.
  [[nodiscard]] HWY_INLINE Numbers times_t() const {
    alignas(64) static constexpr float kPower[16] = {0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7};
    static_assert(kMoments == 8 && kCount == 2 * kMoments);
#if HWY_TARGET != HWY_SCALAR
    if constexpr (kLanes >= kMoments) {
      alignas(64) static constexpr std::int32_t kBefore[16] = {0, 0, 1, 2, 3, 4, 5, 6, 0, 8, 9, 10, 11, 12, 13, 14};
      const auto before = hn::SetTableIndices(Tag(), kBefore);
      return make([&](std::size_t v) HWY_ATTR {
        return hn::Mul(hn::Load(Tag(), kPower + v * kLanes), hn::TableLookupLanes(part[v], before));
      });
    }
#endif
    alignas(64) float from[kCount], to[kCount];
    store(from);
    for (std::size_t i = 0; i < kCount; ++i) to[i] = i % kMoments == 0 ? 0.0f : kPower[i] * from[i - 1];
    return load(to);
  }
  friend HWY_INLINE Numbers operator+(Numbers a, Numbers b) {
    return make([&](std::size_t v) HWY_ATTR { return hn::Add(a.part[v], b.part[v]); });
  }
  friend HWY_INLINE Numbers operator-(Numbers a, Numbers b) {
    return make([&](std::size_t v) HWY_ATTR { return hn::Sub(a.part[v], b.part[v]); });
  }
  friend HWY_INLINE Numbers operator*(Numbers a, Numbers b) {
    return make([&](std::size_t v) HWY_ATTR { return hn::Mul(a.part[v], b.part[v]); });
  }
  friend HWY_INLINE Numbers multiply_add(Numbers a, Numbers b, Numbers c) {  // a b + c
    return make([&](std::size_t v) HWY_ATTR { return hn::MulAdd(a.part[v], b.part[v], c.part[v]); });
  }
  friend HWY_INLINE Numbers subtract_product(Numbers a, Numbers b, Numbers c) {  // c - a b
    return make([&](std::size_t v) HWY_ATTR { return hn::NegMulAdd(a.part[v], b.part[v], c.part[v]); });
  }
};
using Eight = Numbers<kMoments>;
using Pair = Numbers<2 * kMoments>;  // real parts, then imaginary ones

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // the toggle
