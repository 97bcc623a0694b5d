#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>

#include "engine/synth/kernels/drive_kernel.h"

#include "engine/synth/kernels/mode_vectors-inl.h"

#include <algorithm>

// A chunk under forces
//
// An impulse changes the states in the frame in which it acts, so a mode under a force has no closed form over a chunk,
// and its recurrence is run frame by frame in double: the sample is Re z; each force subtracts (impulse) x (amplitude)
// from Im z, which starts a sine; then z <- z p. Lanes are modes, and the states of four vectors stay in registers for
// the whole chunk, because one vector alone would spend most of its time waiting for its own products. The sum over
// lanes is left for the end: until then each frame keeps one vector of partial sums.
HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

// Partial sums, one vector for each sample, whose lanes are added up at the end.
struct Sums {
  alignas(64) double lanes[kChunkFrames * kModePadding];
};

// Returns poles for a Doppler-shifted time.
HWY_INLINE Complex shifted(Complex pole, const Hearing& hearing, std::size_t at) {
  if (hearing.rate == 1 || hearing.log_re == nullptr) return pole;
  const Tag tag;
  const Vec faster = hn::Set(tag, hearing.rate - 1);
  const Vec size = hn::Exp(tag, hn::Mul(faster, hn::Load(tag, hearing.log_re + at)));
  const Vec angle = hn::Mul(faster, hn::Load(tag, hearing.log_im + at));
  return multiply(pole, {hn::Mul(size, hn::Cos(tag, angle)), hn::Mul(size, hn::Sin(tag, angle))});
}

// The gains of the modes of a few vectors, and their steps per frame.
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

// Adds one frame of a few vectors of modes, at their gains, to its partial sums at `to`, and advances the gains.
template <std::size_t kVectors, bool kHeard>
HWY_INLINE void add_heard(const Complex* z, Gains<kHeard ? kVectors : 0>& gains, double* to) {
  const Tag tag;
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
}

// Stores the states of a few vectors of modes. Returns their energy, by lanes.
template <std::size_t kVectors>
HWY_INLINE Vec store_vectors(const Complex* z, const ModeArrays& modes, std::size_t first) {
  const Tag tag;
  Vec energy = hn::Zero(tag);
  RINGDOWN_UNROLL
  for (std::size_t v = 0; v < kVectors; ++v) {
    store_states(z[v], modes, first + v * hn::Lanes(tag));
    energy = hn::Add(energy, norm(z[v]));
  }
  return energy;
}

// Runs drive.vectors<kVectors, kHeard>(first, sums) over all columns, several vectors together while there are enough.
// Returns the remaining energy, and adds the samples to `out` unless that energy is absurd (kAbsurdEnergy).
template <class Drive>
HWY_INLINE double drive_columns(const ModeArrays& modes, std::size_t columns, const Drive& drive, double* out,
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
    energy = hn::Add(energy, heard ? drive.template vectors<kTogether, true>(at, sums)
                                   : drive.template vectors<kTogether, false>(at, sums));
  }
  for (; at < columns; at += lanes) {
    energy =
        hn::Add(energy, heard ? drive.template vectors<1, true>(at, sums) : drive.template vectors<1, false>(at, sums));
  }
  const double left = hn::GetLane(hn::SumOfLanes(tag, energy));
  for (std::size_t n = 0; n < frames && left <= kAbsurdEnergy; ++n) {
    out[n] += hn::GetLane(hn::SumOfLanes(tag, hn::Load(tag, sums.lanes + n * lanes)));
  }
  return left;
}

// A few vectors of modes at once, whose chains of products run in parallel.
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
    add_heard<kVectors, kHeard>(z, gains, sums.lanes + n * lanes);
    for (std::size_t f = 0; f < forces.size(); ++f) {
      const Vec impulse = hn::Set(tag, forces[f].samples[n]);
      RINGDOWN_UNROLL
      for (std::size_t v = 0; v < kVectors; ++v) z[v].im = hn::NegMulAdd(impulse, amplitude[f][v], z[v].im);
    }
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) z[v] = multiply(z[v], p[v]);
  }
  return store_vectors<kVectors>(z, modes, first);
}

struct UnderForces {
  const ModeArrays& modes;
  std::span<const Force> forces;
  std::size_t frames;
  template <std::size_t kVectors, bool kHeard>
  HWY_INLINE Vec vectors(std::size_t first, Sums& sums) const {
    return drive_vectors<kVectors, kHeard>(modes, first, forces, frames, sums);
  }
};

double drive_modes_here(const ModeArrays& modes, std::size_t columns, std::span<const Force> forces, double* out,
                        std::size_t frames) {
  return drive_columns(modes, columns, UnderForces{modes, forces, frames}, out, frames);
}

// Modes under forces that are constant over each step (engine/contact): z <- z p + (force) x (kick).
template <std::size_t kVectors, bool kHeard>
HWY_INLINE Vec drive_touched_vectors(const ModeArrays& modes, std::size_t first, std::span<const Force> forces,
                                     std::span<const PortForce> ports, std::size_t frames, std::size_t substeps,
                                     Sums& sums) {
  const Tag tag;
  const std::size_t lanes = hn::Lanes(tag);
  Complex z[kVectors], p[kVectors];
  RINGDOWN_UNROLL
  for (std::size_t v = 0; v < kVectors; ++v) {
    z[v] = load_states(modes, first + v * lanes);
    p[v] = load_poles(modes, first + v * lanes);
  }
  Gains<kHeard ? kVectors : 0> gains(modes.hearing, first);
  std::size_t step = 0;
  for (std::size_t n = 0; n < frames; ++n) {
    add_heard<kVectors, kHeard>(z, gains, sums.lanes + n * lanes);
    for (const Force& force : forces) {
      const Vec impulse = hn::Set(tag, force.samples[n]);
      RINGDOWN_UNROLL
      for (std::size_t v = 0; v < kVectors; ++v) {
        z[v].im = hn::NegMulAdd(impulse, hn::Load(tag, force.amplitudes + first + v * lanes), z[v].im);
      }
    }
    for (std::size_t k = 0; k < substeps; ++k, ++step) {
      RINGDOWN_UNROLL
      for (std::size_t v = 0; v < kVectors; ++v) z[v] = multiply(z[v], p[v]);
      for (const PortForce& port : ports) {
        const Vec force = hn::Set(tag, port.samples[step]);
        RINGDOWN_UNROLL
        for (std::size_t v = 0; v < kVectors; ++v) {
          z[v].re = hn::MulAdd(force, hn::Load(tag, port.kick_re + first + v * lanes), z[v].re);
          z[v].im = hn::MulAdd(force, hn::Load(tag, port.kick_im + first + v * lanes), z[v].im);
        }
      }
    }
  }
  return store_vectors<kVectors>(z, modes, first);
}

struct UnderTouches {
  const ModeArrays& modes;
  std::span<const Force> forces;
  std::span<const PortForce> ports;
  std::size_t frames, substeps;
  template <std::size_t kVectors, bool kHeard>
  HWY_INLINE Vec vectors(std::size_t first, Sums& sums) const {
    return drive_touched_vectors<kVectors, kHeard>(modes, first, forces, ports, frames, substeps, sums);
  }
};

double drive_touched_here(const ModeArrays& modes, std::size_t columns, std::span<const Force> forces,
                          std::span<const PortForce> ports, double* out, std::size_t frames, std::size_t substeps) {
  return drive_columns(modes, columns, UnderTouches{modes, forces, ports, frames, substeps}, out, frames);
}

// Adds the surface displacement of a few vectors of modes at kPlaces places to sums of lanes, for each step. Nothing
// acts on the modes, so Re z follows x[n + 1] = 2 Re p x[n] - |p|^2 x[n - 1], half the work of z <- z p. Rounding
// errors grow as n^2, to 5e-13 of |z| after 64 steps.
template <std::size_t kPlaces, std::size_t kVectors>
HWY_INLINE void move_places(const ModeArrays& modes, std::size_t first, const double* const* weights, std::size_t count,
                            double* sums) {
  const Tag tag;
  const std::size_t lanes = hn::Lanes(tag);
  Vec now[kVectors], next[kVectors], by_next[kVectors], by_now[kVectors], weight[kPlaces][kVectors];
  RINGDOWN_UNROLL
  for (std::size_t v = 0; v < kVectors; ++v) {
    const Complex z = load_states(modes, first + v * lanes), p = load_poles(modes, first + v * lanes);
    now[v] = z.re;
    next[v] = multiply(z, p).re;
    by_next[v] = hn::Add(p.re, p.re);
    by_now[v] = norm(p);
    RINGDOWN_UNROLL
    for (std::size_t k = 0; k < kPlaces; ++k) weight[k][v] = hn::Load(tag, weights[k] + first + v * lanes);
  }
  for (std::size_t n = 0; n < count; ++n) {
    RINGDOWN_UNROLL
    for (std::size_t k = 0; k < kPlaces; ++k) {
      double* const to = sums + (k * kChunkFrames + n) * lanes;
      Vec sum = hn::Load(tag, to);
      RINGDOWN_UNROLL
      for (std::size_t v = 0; v < kVectors; ++v) sum = hn::MulAdd(weight[k][v], now[v], sum);
      hn::Store(sum, tag, to);
    }
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) {
      const Vec after = hn::MulSub(by_next[v], next[v], hn::Mul(by_now[v], now[v]));
      now[v] = next[v];
      next[v] = after;
    }
  }
}

template <std::size_t kPlaces>
HWY_INLINE void move_some(const ModeArrays& modes, std::size_t columns, const double* const* weights,
                          double* const* out, std::size_t count) {
  const Tag tag;
  const std::size_t lanes = hn::Lanes(tag);
  alignas(64) double sums[kPlaces * kChunkFrames * kModePadding];
  for (std::size_t k = 0; k < kPlaces; ++k) std::fill_n(sums + k * kChunkFrames * lanes, count * lanes, 0.0);
  constexpr std::size_t kTogether = 3;
  std::size_t at = 0;
  for (; at + kTogether * lanes <= columns; at += kTogether * lanes) {
    move_places<kPlaces, kTogether>(modes, at, weights, count, sums);
  }
  for (; at < columns; at += lanes) move_places<kPlaces, 1>(modes, at, weights, count, sums);
  for (std::size_t k = 0; k < kPlaces; ++k) {
    for (std::size_t n = 0; n < count; ++n) {
      out[k][n] = hn::GetLane(hn::SumOfLanes(tag, hn::Load(tag, sums + (k * kChunkFrames + n) * lanes)));
    }
  }
}

void free_motion_here(const ModeArrays& modes, std::size_t columns, std::span<const double* const> weights,
                      std::span<double* const> out, std::size_t count) {
  std::size_t at = 0;
  for (; at + 3 <= weights.size(); at += 3) move_some<3>(modes, columns, &weights[at], &out[at], count);
  for (; at + 2 <= weights.size(); at += 2) move_some<2>(modes, columns, &weights[at], &out[at], count);
  for (; at < weights.size(); ++at) move_some<1>(modes, columns, &weights[at], &out[at], count);
}

void add_taps_here(std::span<const TapRow> rows, std::size_t count) {
  const Tag tag;
  const std::size_t lanes = hn::Lanes(tag);
  for (const TapRow& row : rows) {
    const Vec force = hn::Set(tag, row.force);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) {
      hn::StoreU(hn::NegMulAdd(force, hn::Load(tag, row.taps + i), hn::LoadU(tag, row.to + i)), tag, row.to + i);
    }
    for (; i < count; ++i) row.to[i] -= row.force * row.taps[i];
  }
}

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ringdown::synth {

HWY_EXPORT(drive_modes_here);
HWY_EXPORT(drive_touched_here);
HWY_EXPORT(free_motion_here);
HWY_EXPORT(add_taps_here);

// Highway's dispatch reads an atomic, and indexes a table of functions, all of them in this file.
TRUST_REALTIME_BEGIN
double drive_modes(const ModeArrays& modes, std::size_t columns, std::span<const Force> forces, double* out,
                   std::size_t frames) REALTIME {
  return HWY_DYNAMIC_DISPATCH(drive_modes_here)(modes, columns, forces, out, frames);
}
double drive_touched(const ModeArrays& modes, std::size_t columns, std::span<const Force> forces,
                     std::span<const PortForce> ports, double* out, std::size_t frames, std::size_t substeps) REALTIME {
  return HWY_DYNAMIC_DISPATCH(drive_touched_here)(modes, columns, forces, ports, out, frames, substeps);
}
void free_motion(const ModeArrays& modes, std::size_t columns, std::span<const double* const> weights,
                 std::span<double* const> out, std::size_t count) REALTIME {
  HWY_DYNAMIC_DISPATCH(free_motion_here)(modes, columns, weights, out, count);
}
void add_taps(std::span<const TapRow> rows, std::size_t count) REALTIME {
  HWY_DYNAMIC_DISPATCH(add_taps_here)(rows, count);
}
TRUST_REALTIME_END

}  // namespace ringdown::synth
#endif
