#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>

#include "engine/synth/kernels/drive_kernel.h"

#include "engine/synth/kernels/mode_vectors-inl.h"

#include <algorithm>
#include <utility>

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

// Modes under forces that are constant over each step (engine/contact): z <- z p + (sum of force x weight) x response.
template <std::size_t kVectors, bool kHeard>
HWY_INLINE Vec drive_touched_vectors(const ModeArrays& modes, std::size_t first, std::span<const Force> forces,
                                     const PortForces& pushed, std::size_t frames, std::size_t substeps, Sums& sums) {
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
      for (std::size_t v = 0; v < kVectors; ++v) {
        z[v] = multiply(z[v], p[v]);
        if (pushed.ports.empty()) continue;
        const std::size_t at = first + v * lanes;
        Vec push = hn::Zero(tag);
        for (const PortForce& port : pushed.ports) {
          push = hn::MulAdd(hn::Set(tag, port.samples[step]), hn::Load(tag, port.weight + at), push);
        }
        z[v].re = hn::MulAdd(push, hn::Load(tag, pushed.response_re + at), z[v].re);
        z[v].im = hn::MulAdd(push, hn::Load(tag, pushed.response_im + at), z[v].im);
      }
    }
  }
  return store_vectors<kVectors>(z, modes, first);
}

struct UnderTouches {
  const ModeArrays& modes;
  std::span<const Force> forces;
  const PortForces& ports;
  std::size_t frames, substeps;
  template <std::size_t kVectors, bool kHeard>
  HWY_INLINE Vec vectors(std::size_t first, Sums& sums) const {
    return drive_touched_vectors<kVectors, kHeard>(modes, first, forces, ports, frames, substeps, sums);
  }
};

double drive_touched_here(const ModeArrays& modes, std::size_t columns, std::span<const Force> forces,
                          const PortForces& ports, double* out, std::size_t frames, std::size_t substeps) {
  return drive_columns(modes, columns, UnderTouches{modes, forces, ports, frames, substeps}, out, frames);
}

// The final state is z p^N + response x y, where y = sum of u[n] p^(N - 1 - n), and u[n] is the sum of force x weight
// in step n. As u is real, b[n] = u[n] + 2 Re p b[n - 1] - |p|^2 b[n - 2] is, too, and y = b[N - 1] - conj(p) b[N - 2]:
// half the work of complex products (Goertzel). Its rounding errors are those of move_places().
template <std::size_t kPorts, std::size_t kVectors>
HWY_INLINE void push_vectors(const ModeArrays& modes, std::size_t first, const PortForces& pushed, std::size_t steps) {
  const Tag tag;
  const std::size_t lanes = hn::Lanes(tag);
  Vec now[kVectors], before[kVectors], by_now[kVectors], by_before[kVectors];
  RINGDOWN_UNROLL
  for (std::size_t v = 0; v < kVectors; ++v) {
    const Complex p = load_poles(modes, first + v * lanes);
    now[v] = before[v] = hn::Zero(tag);
    by_now[v] = hn::Add(p.re, p.re);
    by_before[v] = norm(p);
  }
  const auto add_push = [&](std::size_t n, std::size_t v, Vec sum) HWY_ATTR {
    RINGDOWN_UNROLL
    for (std::size_t k = 0; k < kPorts; ++k) {
      const PortForce& port = pushed.ports[k];
      sum = hn::MulAdd(hn::Set(tag, port.samples[n]), hn::Load(tag, port.weight + first + v * lanes), sum);
    }
    return sum;
  };
  std::size_t n = 0;
  for (; n + 2 <= steps; n += 2) {  // two steps at once, so that no vector has to move
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) {
      const Vec old = hn::NegMulAdd(by_before[v], before[v], add_push(n, v, hn::Zero(tag)));
      before[v] = hn::MulAdd(by_now[v], now[v], old);
      const Vec older = hn::NegMulAdd(by_before[v], now[v], add_push(n + 1, v, hn::Zero(tag)));
      now[v] = hn::MulAdd(by_now[v], before[v], older);
    }
  }
  for (; n < steps; ++n) {
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) {
      const Vec old = hn::NegMulAdd(by_before[v], before[v], add_push(n, v, hn::Zero(tag)));
      before[v] = std::exchange(now[v], hn::MulAdd(by_now[v], now[v], old));
    }
  }
  RINGDOWN_UNROLL
  for (std::size_t v = 0; v < kVectors; ++v) {
    const std::size_t at = first + v * lanes;
    const Complex p = load_poles(modes, at);
    const Complex y{hn::NegMulAdd(p.re, before[v], now[v]), hn::Mul(p.im, before[v])};
    const Complex pushes =
        multiply(y, {hn::Load(tag, pushed.response_re + at), hn::Load(tag, pushed.response_im + at)});
    const Complex z = load_states(modes, at);
    store_states({hn::Add(z.re, pushes.re), hn::Add(z.im, pushes.im)}, modes, at);
  }
}

template <std::size_t kPorts>
HWY_INLINE void push_some(const ModeArrays& modes, std::size_t columns, const PortForces& pushed, std::size_t steps) {
  constexpr std::size_t kTogether = 2;
  const std::size_t lanes = hn::Lanes(Tag());
  std::size_t at = 0;
  for (; at + kTogether * lanes <= columns; at += kTogether * lanes) {
    push_vectors<kPorts, kTogether>(modes, at, pushed, steps);
  }
  for (; at < columns; at += lanes) push_vectors<kPorts, 1>(modes, at, pushed, steps);
}

double push_touched_here(const ModeArrays& modes, std::size_t columns, const PortForces& pushed, std::size_t steps) {
  const Tag tag;
  const std::size_t lanes = hn::Lanes(tag);
  for (std::size_t at = 0; at < columns; at += lanes) {
    store_states(multiply(load_states(modes, at), power(load_poles(modes, at), steps)), modes, at);
  }
  for (std::size_t k = 0; k < pushed.ports.size(); k += 3) {
    const std::size_t count = std::min<std::size_t>(3, pushed.ports.size() - k);
    const PortForces some{pushed.response_re, pushed.response_im, pushed.ports.subspan(k, count)};
    if (count == 3) push_some<3>(modes, columns, some, steps);
    if (count == 2) push_some<2>(modes, columns, some, steps);
    if (count == 1) push_some<1>(modes, columns, some, steps);
  }
  Vec energy = hn::Zero(tag);
  for (std::size_t at = 0; at < columns; at += lanes) energy = hn::Add(energy, norm(load_states(modes, at)));
  return hn::GetLane(hn::SumOfLanes(tag, energy));
}

// Adds the surface displacement of a few vectors of modes at kPlaces places to sums of lanes, for each step. Nothing
// acts on the modes, so Re z follows x[n + 1] = 2 Re p x[n] - |p|^2 x[n - 1], half the work of z <- z p. Rounding
// errors grow as n^2, to 5e-13 of |z| after 64 steps.
template <std::size_t kPlaces, std::size_t kVectors>
HWY_INLINE void move_places(const ModeArrays& modes, std::size_t first, const double* const* weights, std::size_t count,
                            double* sums) {
  const Tag tag;
  const std::size_t lanes = hn::Lanes(tag);
  Vec now[kVectors], next[kVectors], by_next[kVectors], by_now[kVectors];
  RINGDOWN_UNROLL
  for (std::size_t v = 0; v < kVectors; ++v) {
    const Complex z = load_states(modes, first + v * lanes), p = load_poles(modes, first + v * lanes);
    now[v] = z.re;
    next[v] = multiply(z, p).re;
    by_next[v] = hn::Add(p.re, p.re);
    by_now[v] = norm(p);
  }
  const auto add_to = [&](std::size_t n, const Vec* values) HWY_ATTR {
    RINGDOWN_UNROLL
    for (std::size_t k = 0; k < kPlaces; ++k) {
      double* const to = sums + (k * kChunkFrames + n) * lanes;
      Vec sum = hn::Load(tag, to);
      RINGDOWN_UNROLL
      for (std::size_t v = 0; v < kVectors; ++v) {
        sum = hn::MulAdd(hn::Load(tag, weights[k] + first + v * lanes), values[v], sum);
      }
      hn::Store(sum, tag, to);
    }
  };
  std::size_t n = 0;
  for (; n + 2 <= count; n += 2) {  // two steps at once, so that no vector has to move
    add_to(n, now);
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) {
      now[v] = hn::MulSub(by_next[v], next[v], hn::Mul(by_now[v], now[v]));
    }
    add_to(n + 1, next);
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) {
      next[v] = hn::MulSub(by_next[v], now[v], hn::Mul(by_now[v], next[v]));
    }
  }
  if (n < count) add_to(n, now);
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
  for (; at + 4 <= weights.size(); at += 4) move_some<4>(modes, columns, &weights[at], &out[at], count);
  for (; at + 3 <= weights.size(); at += 3) move_some<3>(modes, columns, &weights[at], &out[at], count);
  for (; at + 2 <= weights.size(); at += 2) move_some<2>(modes, columns, &weights[at], &out[at], count);
  for (; at < weights.size(); ++at) move_some<1>(modes, columns, &weights[at], &out[at], count);
}

void add_taps_here(std::span<const TapRow> rows, std::size_t count) {
  const Tag tag;
  const std::size_t lanes = hn::Lanes(tag);
  for (const TapRow& row : rows) {
    const Vec force = hn::Set(tag, row.force);
    for (std::size_t i = 0; i < count; i += lanes) {
      hn::StoreU(hn::NegMulAdd(force, hn::Load(tag, row.taps + i), hn::LoadU(tag, row.to + i)), tag, row.to + i);
    }
  }
}

void add_answer_here(const double* force, const double* answer, double* out, std::size_t count) {
  const Tag tag;
  const std::size_t lanes = hn::Lanes(tag);
  constexpr std::size_t kVectors = kAnswerPadding / hn::MaxLanes(Tag());
  for (std::size_t first = 0; first < count; first += kAnswerPadding) {
    Vec sum[kVectors];
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) sum[v] = hn::LoadU(tag, out + first + v * lanes);
    for (std::size_t m = 0; m < first + kAnswerPadding; ++m) {
      const Vec push = hn::Set(tag, force[m]);
      const double* const from = answer + first - 1 - m;
      RINGDOWN_UNROLL
      for (std::size_t v = 0; v < kVectors; ++v) {
        sum[v] = hn::MulAdd(push, hn::LoadU(tag, from + v * lanes), sum[v]);
      }
    }
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) hn::StoreU(sum[v], tag, out + first + v * lanes);
  }
}

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ringdown::synth {

HWY_EXPORT(drive_modes_here);
HWY_EXPORT(drive_touched_here);
HWY_EXPORT(push_touched_here);
HWY_EXPORT(free_motion_here);
HWY_EXPORT(add_taps_here);
HWY_EXPORT(add_answer_here);

// Highway's dispatch reads an atomic, and indexes a table of functions, all of them in this file.
TRUST_REALTIME_BEGIN
double drive_modes(const ModeArrays& modes, std::size_t columns, std::span<const Force> forces, double* out,
                   std::size_t frames) REALTIME {
  return HWY_DYNAMIC_DISPATCH(drive_modes_here)(modes, columns, forces, out, frames);
}
double drive_touched(const ModeArrays& modes, std::size_t columns, std::span<const Force> forces,
                     const PortForces& ports, double* out, std::size_t frames, std::size_t substeps) REALTIME {
  if (out == nullptr) return HWY_DYNAMIC_DISPATCH(push_touched_here)(modes, columns, ports, frames * substeps);
  return HWY_DYNAMIC_DISPATCH(drive_touched_here)(modes, columns, forces, ports, out, frames, substeps);
}
void free_motion(const ModeArrays& modes, std::size_t columns, std::span<const double* const> weights,
                 std::span<double* const> out, std::size_t count) REALTIME {
  HWY_DYNAMIC_DISPATCH(free_motion_here)(modes, columns, weights, out, count);
}
void add_taps(std::span<const TapRow> rows, std::size_t count) REALTIME {
  HWY_DYNAMIC_DISPATCH(add_taps_here)(rows, count);
}
void add_answer(const double* force, const double* answer, double* out, std::size_t count) REALTIME {
  HWY_DYNAMIC_DISPATCH(add_answer_here)(force, answer, out, count);
}
TRUST_REALTIME_END

}  // namespace ringdown::synth
#endif
