#include <hwy/highway.h>

#include "engine/synth/kernels/mode_kernel.h"

#include "engine/synth/kernels/mode_vectors-inl.h"

#include <algorithm>

// A chunk by tables
//
// Frame n of a chunk is written as n = kRun r + l. Mode z then sounds as Re(z p^(kRun r) p^l): a product of an anchor,
// z p^(kRun r), and of an entry of the mode's run, p^l for l < kRun, which was computed once in double and rounded to
// float. Over all modes this is a product of two real matrices, anchors (runs x 2 modes) times runs (2 modes x kRun),
// so a sample costs each mode two multiply-adds, none of which waits for the previous frame. The plain recurrence z <-
// z p would take four in sequence, and would accumulate the rounding of every frame.
//
// render_modes_here() takes the active groups in batches. advance_group() fills in the anchors of a group, moves its
// states on in double by p^frames, and measures the remaining energy. add_batch() multiplies: it holds the sums of as
// many runs as fit into eight vector registers, goes through the batch for them, then takes the next runs. The sums of
// a chunk are float and are added to the output in double at the end; if a state was absurd, nothing is added.
HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

constexpr std::size_t kMaxRuns = kChunkFrames / kRun;

// z p^(kRun r) of a group's modes for r < kMaxRuns, in float.
struct Anchors {
  alignas(64) float re[kMaxRuns][kModePadding], im[kMaxRuns][kModePadding];
};

// Multiplies the anchors of a group by the gains of its modes. A moving gain is constant within a run, with its value
// in the run's middle.
HWY_INLINE void hear_group(const Hearing& hearing, std::size_t first, std::size_t runs, Anchors& anchors) {
  const hn::CappedTag<float, kModePadding> tag;
  for (std::size_t i = 0; i < kModePadding; i += hn::Lanes(tag)) {
    auto gain_re = hn::Load(tag, hearing.gain_re + first + i), gain_im = hn::Load(tag, hearing.gain_im + first + i);
    auto step_re = hn::Zero(tag), step_im = hn::Zero(tag);
    if (hearing.step_re != nullptr) {
      step_re = hn::Load(tag, hearing.step_re + first + i);
      step_im = hn::Load(tag, hearing.step_im + first + i);
      const auto middle = hn::Set(tag, hearing.offset + 0.5f * static_cast<float>(kRun - 1));
      gain_re = hn::MulAdd(step_re, middle, gain_re);
      gain_im = hn::MulAdd(step_im, middle, gain_im);
      const auto run = hn::Set(tag, static_cast<float>(kRun));
      step_re = hn::Mul(step_re, run);
      step_im = hn::Mul(step_im, run);
    }
    for (std::size_t r = 0; r < runs; ++r) {
      const auto re = hn::Load(tag, anchors.re[r] + i), im = hn::Load(tag, anchors.im[r] + i);
      hn::Store(hn::NegMulAdd(im, gain_im, hn::Mul(re, gain_re)), tag, anchors.re[r] + i);
      hn::Store(hn::MulAdd(im, gain_re, hn::Mul(re, gain_im)), tag, anchors.im[r] + i);
      gain_re = hn::Add(gain_re, step_re);
      gain_im = hn::Add(gain_im, step_im);
    }
  }
}

// Fills in `runs` anchors of a group, moves its states on, and checks the new states.
HWY_INLINE void advance_group(const ModeArrays& modes, std::size_t first, std::size_t frames, std::size_t runs,
                              Anchors& anchors, EnergyCheck& check) {
  const Tag tag;
  const hn::CappedTag<float, hn::MaxLanes(Tag())> narrow;
  const std::size_t lanes = hn::Lanes(tag);
  RINGDOWN_UNROLL
  for (std::size_t i = 0; i < kModePadding; i += lanes) {
    const Complex z = load_states(modes, first + i);
    const Complex next = multiply(z, advance_of(modes, first + i, frames));
    store_states(next, modes, first + i);
    check.look_at(next);
    auto re = hn::DemoteTo(narrow, z.re), im = hn::DemoteTo(narrow, z.im);
    const auto stride_re = hn::Load(narrow, modes.stride_re + first + i),
               stride_im = hn::Load(narrow, modes.stride_im + first + i);
    for (std::size_t r = 0; r < runs; ++r) {
      hn::Store(re, narrow, anchors.re[r] + i);
      hn::Store(im, narrow, anchors.im[r] + i);
      const auto turned = hn::NegMulAdd(im, stride_im, hn::Mul(re, stride_re));
      im = hn::MulAdd(im, stride_re, hn::Mul(re, stride_im));
      re = turned;
    }
  }
}

// A few groups that are summed together.
struct Batch {
  static constexpr std::size_t kMaxGroups = 4;
  std::size_t count = 0;
  Anchors anchors[kMaxGroups];
  const float* runs[kMaxGroups];  // runs of each group's modes
};

// Adds the products of mode m's anchors, real or imaginary parts, and of its run. An anchor is used up before the next
// is read: if all were read first, the sums would have to leave their registers, where AVX2 has 16.
template <std::size_t kRuns, class Vector>
HWY_INLINE void add_mode(const float (*anchors)[kModePadding], std::size_t first_run, std::size_t m, const float* run,
                         Vector* sums) {
  const hn::CappedTag<float, kRun> tag;
  constexpr std::size_t kLanes = hn::MaxLanes(hn::CappedTag<float, kRun>()), kParts = kRun / kLanes;
  Vector part[kParts];
  RINGDOWN_UNROLL
  for (std::size_t i = 0; i < kParts; ++i) part[i] = hn::Load(tag, run + i * kLanes);
  RINGDOWN_UNROLL
  for (std::size_t r = 0; r < kRuns; ++r) {
    const auto anchor = hn::Set(tag, anchors[first_run + r][m]);
    RINGDOWN_UNROLL
    for (std::size_t i = 0; i < kParts; ++i) sums[r * kParts + i] = hn::MulAdd(anchor, part[i], sums[r * kParts + i]);
  }
}

// Adds kRuns runs of a batch, from run `first_run` on, to `sums`; the sums stay in registers. With four sums or fewer
// each addition would have to wait for the one before it, so there are two sets of sums then: one for the products of
// real parts and one for those of imaginary parts.
template <std::size_t kRuns>
HWY_NOINLINE void add_runs(const Batch& batch, std::size_t first_run, float* HWY_RESTRICT sums) {
  const hn::CappedTag<float, kRun> tag;
  constexpr std::size_t kLanes = hn::MaxLanes(hn::CappedTag<float, kRun>()), kParts = kRun / kLanes;
  constexpr std::size_t kSums = kRuns * kParts, kSets = kSums <= 4 ? 2 : 1;
  hn::Vec<decltype(tag)> sum[kSets][kSums];
  RINGDOWN_UNROLL
  for (std::size_t i = 0; i < kSums; ++i) {
    sum[kSets - 1][i] = hn::Zero(tag);
    sum[0][i] = hn::Load(tag, sums + i * kLanes);
  }
  for (std::size_t g = 0; g < batch.count; ++g) {
    const Anchors& anchors = batch.anchors[g];
    const float* runs = batch.runs[g];
    for (std::size_t m = 0; m < kModePadding; ++m, runs += 2 * kRun) {
      add_mode<kRuns>(anchors.re, first_run, m, runs, sum[0]);
      add_mode<kRuns>(anchors.im, first_run, m, runs + kRun, sum[kSets - 1]);
    }
  }
  RINGDOWN_UNROLL
  for (std::size_t i = 0; i < kSums; ++i) {
    hn::Store(kSets == 1 ? sum[0][i] : hn::Add(sum[0][i], sum[kSets - 1][i]), tag, sums + i * kLanes);
  }
}

// Adds all of a batch's runs from `run` on, at most kRuns at once.
template <std::size_t kRuns>
HWY_INLINE void add_batch(const Batch& batch, std::size_t run, std::size_t runs, float* sums) {
  for (; run + kRuns <= runs; run += kRuns) add_runs<kRuns>(batch, run, sums + run * kRun);
  if constexpr (kRuns > 1) add_batch<kRuns / 2>(batch, run, runs, sums);
}

HWY_INLINE void add_samples(const float* from, double* out, std::size_t frames) {
  const Tag tag;
  const hn::CappedTag<float, hn::MaxLanes(Tag())> narrow;
  std::size_t n = 0;
  for (; n + hn::Lanes(tag) <= frames; n += hn::Lanes(tag)) {
    hn::StoreU(hn::Add(hn::LoadU(tag, out + n), hn::PromoteTo(tag, hn::Load(narrow, from + n))), tag, out + n);
  }
  for (; n < frames; ++n) out[n] += static_cast<double>(from[n]);
}

bool render_modes_here(const ModeArrays& modes, ActiveGroups& active, const EnergyLimits& limits, double* out,
                       std::size_t frames) {
  // The number of runs that eight registers hold.
  constexpr std::size_t kTogether =
      std::clamp<std::size_t>(8 * hn::MaxLanes(hn::CappedTag<float, kRun>()) / kRun, 1, kMaxRuns);
  alignas(64) float sums[kChunkFrames];
  Batch batch;
  EnergyCheck check(limits);
  const std::size_t runs = (frames + kRun - 1) / kRun;
  for (std::size_t n = 0; n < runs * kRun; n += hn::MaxLanes(hn::CappedTag<float, kRun>())) {
    hn::Store(hn::Zero(hn::CappedTag<float, kRun>()), hn::CappedTag<float, kRun>(), sums + n);
  }
  const bool heard = modes.hearing != nullptr && modes.hearing->gain_re != nullptr;
  bool sane = true;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < active.count;) {
    for (batch.count = 0; batch.count < Batch::kMaxGroups && i < active.count; ++batch.count, ++i) {
      const std::uint32_t group = active.list[i];
      const std::size_t first = std::size_t{group} * kModePadding;
      check.begin_group();
      advance_group(modes, first, frames, runs, batch.anchors[batch.count], check);
      if (heard) hear_group(*modes.hearing, first, runs, batch.anchors[batch.count]);
      batch.runs[batch.count] = modes.runs + first * 2 * kRun;
      sane = sane && check.sane();
      active.list[kept] = group;
      kept += check.silent() ? 0 : 1;
      if (check.silent()) forget_states(modes, first);
    }
    add_batch<kTogether>(batch, 0, runs, sums);
  }
  if (!sane) return false;
  active.count = kept;
  add_samples(sums, out, frames);
  return true;
}

void fill_advances_here(const ModeArrays& modes, std::size_t count, std::size_t frames, double* to_re, double* to_im) {
  for (std::size_t i = 0; i < count; i += hn::Lanes(Tag())) {
    const Complex advance = power(load_poles(modes, i), frames);
    hn::Store(advance.re, Tag(), to_re + i);
    hn::Store(advance.im, Tag(), to_im + i);
  }
}

void skip_modes_here(const ModeArrays& modes, std::size_t count, std::uint64_t frames) {
  for (std::size_t i = 0; i < count; i += hn::Lanes(Tag())) {
    store_states(multiply(load_states(modes, i), power(load_poles(modes, i), frames)), modes, i);
  }
}

const char* target_here() { return hwy::TargetName(HWY_TARGET); }

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ringdown::synth {

HWY_EXPORT(render_modes_here);
HWY_EXPORT(fill_advances_here);
HWY_EXPORT(skip_modes_here);
HWY_EXPORT(target_here);

std::array<float, 2 * kRun> run_of(std::complex<double> s) {
  std::array<float, 2 * kRun> run{};
  for (std::size_t l = 0; l < kRun; ++l) {
    const std::complex<double> power = std::exp(s * static_cast<double>(l));
    run[l] = static_cast<float>(power.real());
    run[kRun + l] = static_cast<float>(-power.imag());
  }
  return run;
}

// Highway's dispatch reads an atomic, and indexes a table of functions, all of them in this file.
TRUST_REALTIME_BEGIN
bool render_modes(const ModeArrays& modes, ActiveGroups& active, const EnergyLimits& limits, double* out,
                  std::size_t frames) REALTIME {
  return HWY_DYNAMIC_DISPATCH(render_modes_here)(modes, active, limits, out, frames);
}

void fill_advances(const ModeArrays& modes, std::size_t count, std::size_t frames, double* to_re,
                   double* to_im) REALTIME {
  HWY_DYNAMIC_DISPATCH(fill_advances_here)(modes, count, frames, to_re, to_im);
}

void skip_modes(const ModeArrays& modes, std::size_t count, std::uint64_t frames) REALTIME {
  HWY_DYNAMIC_DISPATCH(skip_modes_here)(modes, count, frames);
}
TRUST_REALTIME_END

const char* kernel_target() { return HWY_DYNAMIC_DISPATCH(target_here)(); }

}  // namespace ringdown::synth
#endif
