#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>

#include "engine/synth/kernels/glide_kernel.h"

#include "engine/synth/kernels/mode_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

void find_turns_here(const double* angles, Turns& turns) {
  const Tag tag;
  const auto store = [tag](Complex turn, Turns::Row& row, std::size_t i) HWY_ATTR {
    hn::Store(turn.re, tag, row.re + i);
    hn::Store(turn.im, tag, row.im + i);
  };
  for (std::size_t i = 0; i < kModePadding; i += hn::Lanes(tag)) {
    const Vec angle = hn::Load(tag, angles + i);
    Complex turn{hn::Cos(tag, angle), hn::Sin(tag, angle)};
    store(turn, turns.frame, i);
    for (std::size_t frames = 1; frames < kChunkFrames;) {
      turn = multiply(turn, turn);
      frames *= 2;
      if (frames == kRun) store(turn, turns.run, i);
    }
    store(turn, turns.chunk, i);
  }
}

void find_weights_here(MovedWeights& weights) {
  const Tag tag;
  const hn::CappedTag<float, hn::MaxLanes(Tag())> narrow;
  const Vec scale = hn::Set(tag, kMomentScale), to_first = hn::Set(tag, kMomentMiddle / kMomentScale);
  for (std::size_t i = 0; i < kModePadding; i += hn::Lanes(tag)) {
    const Vec center = hn::Mul(hn::Load(tag, weights.band + i), hn::Set(tag, kPerBand));
    const Complex delta{hn::Mul(hn::Load(tag, weights.decay + i), scale),
                        hn::Mul(hn::Sub(hn::Load(tag, weights.omega + i), center), scale)};
    const Vec size = hn::Exp(tag, hn::Mul(delta.re, to_first)), angle = hn::Mul(delta.im, to_first);
    Complex power{hn::Mul(size, hn::Cos(tag, angle)), hn::Mul(size, hn::Sin(tag, angle))};
    const Complex x{hn::Add(delta.re, hn::Set(tag, kMomentDecay)), delta.im};
    for (std::size_t p = 0; p < kMoments; ++p) {
      hn::Store(hn::DemoteTo(narrow, power.re), narrow, weights.of[p] + i);
      hn::Store(hn::DemoteTo(narrow, power.im), narrow, weights.of[kMoments + p] + i);
      power = multiply(power, x);
    }
  }
}

void add_shares_here(const std::int8_t* shares, const float* amounts, std::size_t count, float* out) {
  const hn::CappedTag<float, kModePadding> tag;
  const hn::Rebind<std::int8_t, decltype(tag)> bytes;
  const hn::Rebind<std::int32_t, decltype(tag)> integers;
  for (std::size_t i = 0; i < kModePadding; i += hn::Lanes(tag)) {
    auto even = hn::Zero(tag), odd = hn::Zero(tag);  // two sums, so that additions do not wait for each other
    const auto share = [&](std::size_t l) HWY_ATTR {
      return hn::ConvertTo(tag, hn::PromoteTo(integers, hn::LoadU(bytes, shares + l * kModePadding + i)));
    };
    std::size_t l = 0;
    for (; l + 2 <= count; l += 2) {
      even = hn::MulAdd(share(l), hn::Set(tag, amounts[l]), even);
      odd = hn::MulAdd(share(l + 1), hn::Set(tag, amounts[l + 1]), odd);
    }
    if (l < count) even = hn::MulAdd(share(l), hn::Set(tag, amounts[l]), even);
    hn::StoreU(hn::Add(even, odd), tag, out + i);
  }
}

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ringdown::synth {

HWY_EXPORT(find_turns_here);
HWY_EXPORT(find_weights_here);
HWY_EXPORT(add_shares_here);

// Highway's dispatch reads an atomic, and indexes a table of functions, all of them in this file.
TRUST_REALTIME_BEGIN
void find_turns(const double* angles, Turns& turns) REALTIME { HWY_DYNAMIC_DISPATCH(find_turns_here)(angles, turns); }
void find_weights(MovedWeights& weights) REALTIME { HWY_DYNAMIC_DISPATCH(find_weights_here)(weights); }
void add_shares(const std::int8_t* shares, const float* amounts, std::size_t count, float* out) REALTIME {
  HWY_DYNAMIC_DISPATCH(add_shares_here)(shares, amounts, count, out);
}
TRUST_REALTIME_END

}  // namespace ringdown::synth
#endif
