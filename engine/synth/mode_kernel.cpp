#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/synth/mode_kernel.cpp"
#include <hwy/foreach_target.h>  // compiles the rest of this file once per instruction set

#include <hwy/highway.h>

#include "engine/synth/mode_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<double, kModePadding>;
using Vec = hn::Vec<Tag>;

// Loops over a few vectors must unroll, or g++ keeps them in memory instead of registers: measured 2.9 times slower.
// clang unrolls them unasked.
#if defined(__GNUC__) && !defined(__clang__)
#define RINGDOWN_UNROLL _Pragma("GCC unroll 8")
#else
#define RINGDOWN_UNROLL
#endif

struct Complex {
  Vec re, im;
};

HWY_INLINE Complex multiply(Complex a, Complex b) {
  return {hn::NegMulAdd(a.im, b.im, hn::Mul(a.re, b.re)), hn::MulAdd(a.im, b.re, hn::Mul(a.re, b.im))};
}

// p^exponent by repeated squaring: at most 2 log2(kChunkFrames) products, relative error about 1e-15.
HWY_INLINE Complex power(Complex base, std::size_t exponent) {
  const Tag tag;
  Complex result{hn::Set(tag, 1.0), hn::Zero(tag)};
  for (; exponent > 0; exponent >>= 1) {
    if (exponent & 1) result = multiply(result, base);
    base = multiply(base, base);
  }
  return result;
}

// Renders kVectors vectors of modes that start at `first` into per-lane sums. Several vectors at once hide the latency
// of the recurrence.
template <std::size_t kVectors>
HWY_INLINE void render_group(const ModeArrays& modes, std::size_t first, double* HWY_RESTRICT sums, std::size_t frames,
                             Vec& energy) {
  const Tag tag;
  const std::size_t lanes = hn::Lanes(tag);
  // Plain arrays of vectors need a fixed vector size, which all targets but SVE and RVV have.
  Vec now[kVectors], before[kVectors], twice_cosine[kVectors], radius[kVectors];
  RINGDOWN_UNROLL
  for (std::size_t v = 0; v < kVectors; ++v) {
    const std::size_t at = first + v * lanes;
    const Complex z{hn::Load(tag, modes.z_re + at), hn::Load(tag, modes.z_im + at)};
    const Complex pole{hn::Load(tag, modes.pole_re + at), hn::Load(tag, modes.pole_im + at)};
    before[v] = z.re;
    now[v] = multiply(z, pole).re;
    twice_cosine[v] = hn::Add(pole.re, pole.re);
    radius[v] = hn::MulAdd(pole.re, pole.re, hn::Mul(pole.im, pole.im));

    const Complex advance = frames == kChunkFrames ? Complex{hn::Load(tag, modes.chunk_pole_re + at),
                                                             hn::Load(tag, modes.chunk_pole_im + at)}
                                                   : power(pole, frames);
    const Complex next = multiply(z, advance);
    hn::Store(next.re, tag, modes.z_re + at);
    hn::Store(next.im, tag, modes.z_im + at);
    energy = hn::Add(energy, hn::MulAdd(next.re, next.re, hn::Mul(next.im, next.im)));
  }
  for (std::size_t n = 0; n < frames; ++n) {
    Vec sum = hn::Load(tag, sums + n * lanes);
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) {
      sum = hn::Add(sum, before[v]);
      const Vec next = hn::NegMulAdd(radius[v], before[v], hn::Mul(twice_cosine[v], now[v]));
      before[v] = now[v];
      now[v] = next;
    }
    hn::Store(sum, tag, sums + n * lanes);
  }
}

double render_modes_here(const ModeArrays& modes, double* HWY_RESTRICT out, std::size_t frames) {
  constexpr std::size_t kGroup = 4;
  const Tag tag;
  const std::size_t lanes = hn::Lanes(tag);
  HWY_ALIGN double sums[kChunkFrames * kModePadding];
  for (std::size_t i = 0; i < frames * lanes; i += lanes) hn::Store(hn::Zero(tag), tag, sums + i);

  Vec energy = hn::Zero(tag);
  std::size_t mode = 0;
  for (; mode + kGroup * lanes <= modes.count; mode += kGroup * lanes) {
    render_group<kGroup>(modes, mode, sums, frames, energy);
  }
  for (; mode < modes.count; mode += lanes) render_group<1>(modes, mode, sums, frames, energy);

  for (std::size_t n = 0; n < frames; ++n) {
    out[n] += hn::GetLane(hn::SumOfLanes(tag, hn::Load(tag, sums + n * lanes)));
  }
  return hn::GetLane(hn::SumOfLanes(tag, energy));
}

const char* target_here() { return hwy::TargetName(HWY_TARGET); }

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ringdown::synth {

HWY_EXPORT(render_modes_here);
HWY_EXPORT(target_here);

// Highway's dispatch reads an atomic, and indexes a table of functions, all of them in this file.
RINGDOWN_TRUST_REALTIME_BEGIN
double render_modes(const ModeArrays& modes, double* out, std::size_t frames) RINGDOWN_REALTIME {
  return HWY_DYNAMIC_DISPATCH(render_modes_here)(modes, out, frames);
}
RINGDOWN_TRUST_REALTIME_END

const char* kernel_target() { return HWY_DYNAMIC_DISPATCH(target_here)(); }

}  // namespace ringdown::synth
#endif
