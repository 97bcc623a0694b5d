// Modes in SIMD lanes, for the kernels: included once per instruction set, after Highway (its -inl.h convention).
#if defined(RINGDOWN_MODE_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RINGDOWN_MODE_VECTORS_INL_H
#undef RINGDOWN_MODE_VECTORS_INL_H
#else
#define RINGDOWN_MODE_VECTORS_INL_H
#endif

#include "engine/synth/kernels/mode_kernel.h"

#include <hwy/highway.h>

// Loops over a few vectors must unroll, or g++ keeps them in memory instead of registers: measured 2.9 times slower.
// clang unrolls them by itself. Without SIMD a vector is one number, the loops are long, and unrolling only costs
// compile time.
#undef RINGDOWN_UNROLL
#if defined(__GNUC__) && !defined(__clang__) && HWY_TARGET != HWY_SCALAR
#define RINGDOWN_UNROLL _Pragma("GCC unroll 8")
#else
#define RINGDOWN_UNROLL
#endif

HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<double, kModePadding>;
using Vec = hn::Vec<Tag>;

// Constructors are written out, because those that g++ generates are not compiled for the instruction set.
struct Complex {
  HWY_INLINE Complex() {}
  HWY_INLINE Complex(Vec real, Vec imaginary) : re(real), im(imaginary) {}
  Vec re, im;
};

HWY_INLINE Complex multiply(Complex a, Complex b) {
  return {hn::NegMulAdd(a.im, b.im, hn::Mul(a.re, b.re)), hn::MulAdd(a.im, b.re, hn::Mul(a.re, b.im))};
}

HWY_INLINE Vec norm(Complex z) { return hn::MulAdd(z.re, z.re, hn::Mul(z.im, z.im)); }

// p^exponent by repeated squaring: at most 2 log2(exponent) products, relative error about 1e-16 exponent.
HWY_INLINE Complex power(Complex base, std::uint64_t exponent) {
  const Tag tag;
  Complex result{hn::Set(tag, 1.0), hn::Zero(tag)};
  for (; exponent > 0; exponent >>= 1) {
    if (exponent & 1) result = multiply(result, base);
    base = multiply(base, base);
  }
  return result;
}

HWY_INLINE Complex load_states(const ModeArrays& modes, std::size_t at) {
  return {hn::Load(Tag(), modes.z_re + at), hn::Load(Tag(), modes.z_im + at)};
}

HWY_INLINE void store_states(Complex z, const ModeArrays& modes, std::size_t at) {
  hn::Store(z.re, Tag(), modes.z_re + at);
  hn::Store(z.im, Tag(), modes.z_im + at);
}

// Checks |z|^2 of a group's modes against the limits. Each value is compared by itself, because a running maximum loses
// a NaN at the next number.
class EnergyCheck {
 public:
  HWY_INLINE explicit EnergyCheck(const EnergyLimits& limits)
      : floor_(hn::Set(Tag(), limits.floor / kModePadding)), max_(hn::Set(Tag(), limits.max)) {}
  HWY_INLINE void begin_group() { silent_ = sane_ = true; }
  HWY_INLINE void look_at(Complex z) {
    const Vec energy = norm(z);
    silent_ = silent_ && hn::AllTrue(Tag(), hn::Le(energy, floor_));
    sane_ = sane_ && hn::AllTrue(Tag(), hn::Le(energy, max_));
  }
  [[nodiscard]] HWY_INLINE bool silent() const { return silent_; }
  [[nodiscard]] HWY_INLINE bool sane() const { return sane_; }

 private:
  Vec floor_, max_;
  bool silent_ = true, sane_ = true;
};

// Sets states to zero: a group at rest must not come back with old states when the next strike wakes it.
HWY_INLINE void forget_states(const ModeArrays& modes, std::size_t first) {
  const Complex none{hn::Zero(Tag()), hn::Zero(Tag())};
  for (std::size_t i = 0; i < kModePadding; i += hn::Lanes(Tag())) store_states(none, modes, first + i);
}

HWY_INLINE Complex load_poles(const ModeArrays& modes, std::size_t at) {
  return {hn::Load(Tag(), modes.pole_re + at), hn::Load(Tag(), modes.pole_im + at)};
}

// Returns p^frames, from the tables if they hold it.
HWY_INLINE Complex advance_of(const ModeArrays& modes, std::size_t at, std::size_t frames) {
  if (modes.advance_re == nullptr) return power(load_poles(modes, at), frames);
  return {hn::Load(Tag(), modes.advance_re + at), hn::Load(Tag(), modes.advance_im + at)};
}

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // the toggle
