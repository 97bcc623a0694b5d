#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/synth/drive_kernel.cpp"
#include <hwy/foreach_target.h>  // compiles the rest of this file once per instruction set

#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>

#include "engine/synth/drive_kernel.h"

#include "engine/synth/mode_vectors-inl.h"

#include <algorithm>

// A chunk under forces
//
// An impulse adds to the states in the very frame in which it acts, so a mode under a force has no closed form over a
// chunk, and its recurrence is run frame by frame in double: the sample is Re z; each force takes (impulse) x
// (amplitude) off Im z, which starts a sine; then z <- z p. Lanes are modes, and the states of four vectors stay in
// registers for the whole chunk, because one vector alone would spend most of its time waiting for its own products.
// The sum over lanes is left for the end: until then each frame keeps one vector of partial sums.
HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

// Partial sums, one vector for each sample. The lanes of each are added up at the end.
struct Sums {
  alignas(64) double lanes[kChunkFrames * kModePadding];
};

// Poles in a time that runs faster or slower.
HWY_INLINE Complex shifted(Complex pole, const Hearing& hearing, std::size_t at) {
  if (hearing.rate == 1 || hearing.log_re == nullptr) return pole;
  const Tag tag;
  const Vec faster = hn::Set(tag, hearing.rate - 1);
  const Vec size = hn::Exp(tag, hn::Mul(faster, hn::Load(tag, hearing.log_re + at)));
  const Vec angle = hn::Mul(faster, hn::Load(tag, hearing.log_im + at));
  return multiply(pole, {hn::Mul(size, hn::Cos(tag, angle)), hn::Mul(size, hn::Sin(tag, angle))});
}

// The gains at which the modes of a few vectors are heard, and their steps per frame.
template <std::size_t kVectors>
struct Gains {
  Complex now[kVectors], step[kVectors];
  HWY_INLINE Gains(const Hearing* all, std::size_t first) {
    const Hearing& hearing = *all;
    const Tag tag;
    const hn::CappedTag<float, hn::MaxLanes(Tag())> narrow;
    const auto load = [&](const float* from, std::size_t v)
                          HWY_ATTR { return hn::PromoteTo(tag, hn::Load(narrow, from + first + v * hn::Lanes(tag))); };
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) {
      now[v] = {load(hearing.gain_re, v), load(hearing.gain_im, v)};
      step[v] = {hn::Zero(tag), hn::Zero(tag)};
      if (hearing.step_re == nullptr) continue;
      step[v] = {load(hearing.step_re, v), load(hearing.step_im, v)};
      const Vec offset = hn::Set(tag, static_cast<double>(hearing.offset));
      now[v] = {hn::MulAdd(step[v].re, offset, now[v].re), hn::MulAdd(step[v].im, offset, now[v].im)};
    }
  }
};

template <>
struct Gains<0> {
  HWY_INLINE Gains(const Hearing* /*all*/, std::size_t /*first*/) {}
};

// A few vectors of modes at once, whose chains of products run side by side.
template <std::size_t kVectors, bool kHeard>
HWY_INLINE Vec drive_vectors(const ModeArrays& modes, std::size_t first, std::span<const Force> forces,
                             std::size_t frames, Sums& sums) {
  const Tag tag;
  const std::size_t lanes = hn::Lanes(tag);
  Complex z[kVectors], p[kVectors];
  Vec amplitude[kMaxForces][kVectors];
  RINGDOWN_UNROLL
  for (std::size_t v = 0; v < kVectors; ++v) {
    z[v] = load_states(modes, first + v * lanes);
    p[v] = load_poles(modes, first + v * lanes);
    if constexpr (kHeard) p[v] = shifted(p[v], *modes.hearing, first + v * lanes);
    for (std::size_t f = 0; f < forces.size(); ++f) {
      amplitude[f][v] = hn::Load(tag, forces[f].amplitudes + first + v * lanes);
    }
  }
  Gains<kHeard ? kVectors : 0> gains(modes.hearing, first);
  for (std::size_t n = 0; n < frames; ++n) {
    double* const to = sums.lanes + n * lanes;
    Vec sum = hn::Load(tag, to);
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) {
      if constexpr (kHeard) {
        Complex& gain = gains.now[v];
        sum = hn::Add(sum, hn::NegMulAdd(z[v].im, gain.im, hn::Mul(z[v].re, gain.re)));
        gain = {hn::Add(gain.re, gains.step[v].re), hn::Add(gain.im, gains.step[v].im)};
      } else {
        sum = hn::Add(sum, z[v].re);
      }
    }
    hn::Store(sum, tag, to);
    for (std::size_t f = 0; f < forces.size(); ++f) {
      const Vec impulse = hn::Set(tag, forces[f].samples[n]);
      RINGDOWN_UNROLL
      for (std::size_t v = 0; v < kVectors; ++v) z[v].im = hn::NegMulAdd(impulse, amplitude[f][v], z[v].im);
    }
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) z[v] = multiply(z[v], p[v]);
  }
  Vec energy = hn::Zero(tag);
  RINGDOWN_UNROLL
  for (std::size_t v = 0; v < kVectors; ++v) {
    store_states(z[v], modes, first + v * lanes);
    energy = hn::Add(energy, norm(z[v]));
  }
  return energy;
}

double drive_modes_here(const ModeArrays& modes, std::size_t columns, std::span<const Force> forces, double* out,
                        std::size_t frames) {
  constexpr std::size_t kTogether = 4;
  const Tag tag;
  const std::size_t lanes = hn::Lanes(tag);
  Sums sums;
  std::fill_n(sums.lanes, frames * lanes, 0.0);
  Vec energy = hn::Zero(tag);
  std::size_t at = 0;
  const bool heard = modes.hearing != nullptr && modes.hearing->gain_re != nullptr;
  for (; at + kTogether * lanes <= columns; at += kTogether * lanes) {
    energy = hn::Add(energy, heard ? drive_vectors<kTogether, true>(modes, at, forces, frames, sums)
                                   : drive_vectors<kTogether, false>(modes, at, forces, frames, sums));
  }
  for (; at < columns; at += lanes) {
    energy = hn::Add(energy, heard ? drive_vectors<1, true>(modes, at, forces, frames, sums)
                                   : drive_vectors<1, false>(modes, at, forces, frames, sums));
  }
  for (std::size_t n = 0; n < frames; ++n) {
    out[n] += hn::GetLane(hn::SumOfLanes(tag, hn::Load(tag, sums.lanes + n * lanes)));
  }
  return hn::GetLane(hn::SumOfLanes(tag, energy));
}

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ringdown::synth {

HWY_EXPORT(drive_modes_here);

// Highway's dispatch reads an atomic, and indexes a table of functions, all of them in this file.
RINGDOWN_TRUST_REALTIME_BEGIN
double drive_modes(const ModeArrays& modes, std::size_t columns, std::span<const Force> forces, double* out,
                   std::size_t frames) RINGDOWN_REALTIME {
  return HWY_DYNAMIC_DISPATCH(drive_modes_here)(modes, columns, forces, out, frames);
}
RINGDOWN_TRUST_REALTIME_END

}  // namespace ringdown::synth
#endif
