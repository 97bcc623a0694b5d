#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>

#include "engine/synth/kernels/moments.h"

#include "engine/synth/kernels/moment_vectors-inl.h"

#include <cmath>
#include <numbers>

// Modes with individual gains, by moments
//
// A gain that moves in a straight line over the chunk, g (a + b t), is cheap: t exp(delta t) is the derivative of
// exp(delta t) with respect to delta, so the moments of b are those of a moved up by one power (Numbers::times_t()). A
// straight line passes through the zero between two lobes of a mode. A geometric change, which would merely change the
// exponent, would rotate its phase instead: at -31 dB of the lobes for a dipole that turns ten times in a second.
//
// With a Doppler shift, exponents are multiplied by the rate. Bands and weights are then recomputed, in double and in
// SIMD lanes, and the states move on by p^(rate n). A changing rate bends the phase: exp(s bend 4 (j / n) (1 - j / n))
// is taken to first order, which adds a term in t^2.
HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

// Says whether the gains by which modes are heard stand still, move or are shifted in frequency during the call.
enum class Way { still, moving, shifted };

// The sums of one band: for the parts of the sound that are constant, proportional to t, and proportional to t^2.
template <std::size_t kOrders>
class HeardSums {
 public:
  HWY_INLINE HeardSums() {
    for (std::size_t o = 0; o < kOrders; ++o) by_re_[o] = by_im_[o] = Pair::all(0);
  }
  HWY_INLINE void add(const float* re, const float* im, const float* weights) {  // re, im: kOrders x kModePadding
    const Pair weight = Pair::load(weights);
    RINGDOWN_UNROLL
    for (std::size_t o = 0; o < kOrders; ++o) {
      by_re_[o] = multiply_add(Pair::all(re[o * kModePadding]), weight, by_re_[o]);
      by_im_[o] = multiply_add(Pair::all(im[o * kModePadding]), weight, by_im_[o]);
    }
  }
  // Adds modes whose gains change in a straight line: constant parts, then those proportional to t.
  HWY_INLINE void add_lines(const float* re, const float* im, const float* weights) {
    static_assert(kOrders == 1);
    const Pair weight = Pair::load(weights), sloping = weight.times_t();
    by_re_[0] = multiply_add(Pair::all(re[0]), weight, by_re_[0]);
    by_im_[0] = multiply_add(Pair::all(im[0]), weight, by_im_[0]);
    by_re_[0] = multiply_add(Pair::all(re[kModePadding]), sloping, by_re_[0]);
    by_im_[0] = multiply_add(Pair::all(im[kModePadding]), sloping, by_im_[0]);
  }
  [[nodiscard]] HWY_INLINE Pair moments(const float* level_and_slope) const {
    alignas(64) static constexpr float kTurn[2 * kMoments] = {-1, -1, -1, -1, -1, -1, -1, -1, 1, 1, 1, 1, 1, 1, 1, 1};
    const Pair turn = Pair::load(kTurn);
    Pair moments = multiply_add(turn, by_im_[kOrders - 1].turned(), by_re_[kOrders - 1]);
    RINGDOWN_UNROLL
    for (std::size_t done = 1; done < kOrders; ++done) {
      const std::size_t o = kOrders - 1 - done;
      moments = moments.times_t() + multiply_add(turn, by_im_[o].turned(), by_re_[o]);
    }
    if (level_and_slope) {
      moments = multiply_add(Pair::all(level_and_slope[1]), moments.times_t(), Pair::all(level_and_slope[0]) * moments);
    }
    return moments;
  }

 private:
  Pair by_re_[kOrders], by_im_[kOrders];
};

// A group's modes as they are summed.
template <std::size_t kOrders>
struct HeardGroup {
  alignas(64) float re[kOrders * kModePadding], im[kOrders * kModePadding];
  // only with a Doppler shift:
  alignas(64) float own_weights[2 * kMoments * kModePadding];
  alignas(64) double on_re[kModePadding], on_im[kModePadding];  // factors that move the states on
  std::uint16_t own_bands[kModePadding];
};

// Coefficients of a bend's terms in t over the frames of a call: 4 (j / n) (1 - j / n) = c0 + c1 t + c2 t^2.
struct Bend {
  double c0 = 0, c1 = 0, c2 = 0;
  HWY_INLINE Bend(double bend, std::size_t frames) {
    const auto n = static_cast<double>(frames);
    const double scale = 4 * bend / (n * n);
    c0 = scale * kMomentMiddle * (n - kMomentMiddle);
    c1 = scale * kMomentScale * (n - 2 * kMomentMiddle);
    c2 = -scale * kMomentScale * kMomentScale;
  }
};

HWY_INLINE Complex exponential(Complex x) {
  const Tag tag;
  const Vec size = hn::Exp(tag, x.re);
  return {hn::Mul(size, hn::Cos(tag, x.im)), hn::Mul(size, hn::Sin(tag, x.im))};
}

HWY_INLINE Complex scaled(Complex x, double by) {
  const Vec factor = hn::Set(Tag(), by);
  return {hn::Mul(x.re, factor), hn::Mul(x.im, factor)};
}

// Computes the bands and weights of modes with the shifted exponents `s`, like moment_weights(). Modes now above
// Nyquist get zero weights.
template <class Group>
HWY_INLINE void weigh(Complex s, std::size_t i, Group& group) {
  const Tag tag;
  const hn::CappedTag<float, hn::MaxLanes(Tag())> narrow;
  constexpr double kPerBand = std::numbers::pi / static_cast<double>(kChunkFrames);
  const Vec last = hn::Set(tag, static_cast<double>(kBands - 1));
  const Vec band = hn::Min(hn::Max(hn::Round(hn::Mul(s.im, hn::Set(tag, 1 / kPerBand))), hn::Zero(tag)), last);
  const Complex delta = scaled({s.re, hn::NegMulAdd(band, hn::Set(tag, kPerBand), s.im)}, kMomentScale);
  const Complex x{hn::Add(delta.re, hn::Set(tag, kMomentDecay)), delta.im};
  Complex weight = exponential(scaled(delta, kMomentMiddle / kMomentScale));
  const auto heard = hn::Lt(s.im, hn::Set(tag, std::numbers::pi));
  weight = {hn::IfThenElseZero(heard, weight.re), hn::IfThenElseZero(heard, weight.im)};
  const std::size_t lanes = hn::Lanes(tag);
  alignas(64) double bands[kModePadding];
  alignas(64) float re[kModePadding], im[kModePadding];
  hn::Store(band, tag, bands);
  for (std::size_t lane = 0; lane < lanes; ++lane) group.own_bands[i + lane] = static_cast<std::uint16_t>(bands[lane]);
  for (std::size_t p = 0; p < kMoments; ++p) {
    hn::Store(hn::DemoteTo(narrow, weight.re), narrow, re);
    hn::Store(hn::DemoteTo(narrow, weight.im), narrow, im);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      group.own_weights[(i + lane) * 2 * kMoments + p] = re[lane];
      group.own_weights[(i + lane) * 2 * kMoments + kMoments + p] = im[lane];
    }
    weight = multiply(weight, x);
  }
}

// Computes a group's weights and steps for a Doppler shift. Not inlined, because its exponentials are long and several
// functions need it.
template <class Group>
HWY_NOINLINE HWY_ATTR void shift(const ModeArrays& modes, std::size_t first, std::size_t frames, Group& group) {
  const Tag tag;
  const Hearing& hearing = *modes.hearing;
  for (std::size_t i = 0; i < kModePadding; i += hn::Lanes(tag)) {
    const Complex s{hn::Load(tag, hearing.log_re + first + i), hn::Load(tag, hearing.log_im + first + i)};
    weigh(scaled(s, hearing.rate), i, group);
    const Complex on = multiply(advance_of(modes, first + i, frames),
                                exponential(scaled(s, (hearing.rate - 1) * static_cast<double>(frames))));
    hn::Store(on.re, tag, group.on_re + i);
    hn::Store(on.im, tag, group.on_im + i);
  }
}

// Reads a group's states, applies their gains, and moves the states on.
template <Way kWay, std::size_t kOrders>
HWY_INLINE void take_group(const ModeArrays& modes, std::size_t first, std::size_t frames, EnergyCheck& check,
                           HeardGroup<kOrders>& group) {
  const Tag tag;
  const hn::CappedTag<float, hn::MaxLanes(tag)> narrow;
  using Narrow = hn::Vec<decltype(narrow)>;
  const Hearing& hearing = *modes.hearing;
  const std::size_t lanes = hn::Lanes(tag);
  const auto put = [&](std::size_t order, std::size_t i, Narrow re, Narrow im) HWY_ATTR {
    hn::Store(re, narrow, group.re + order * kModePadding + i);
    hn::Store(im, narrow, group.im + order * kModePadding + i);
  };
  const auto times_re = [](Narrow a, Narrow b, Narrow c, Narrow d)
                            HWY_ATTR { return hn::NegMulAdd(b, d, hn::Mul(a, c)); };
  const auto times_im = [](Narrow a, Narrow b, Narrow c, Narrow d) HWY_ATTR { return hn::MulAdd(b, c, hn::Mul(a, d)); };
  if constexpr (kWay == Way::shifted) shift(modes, first, frames, group);
  RINGDOWN_UNROLL
  for (std::size_t i = 0; i < kModePadding; i += lanes) {
    const std::size_t at = first + i;
    const Complex z = load_states(modes, at);
    check.look_at(z);
    const Narrow re = hn::DemoteTo(narrow, z.re), im = hn::DemoteTo(narrow, z.im);
    Narrow gain_re = hn::Set(narrow, 1.0f), gain_im = hn::Zero(narrow), step_re = gain_im, step_im = gain_im;
    if (hearing.gain_re != nullptr) {
      gain_re = hn::Load(narrow, hearing.gain_re + at);
      gain_im = hn::Load(narrow, hearing.gain_im + at);
    }
    if (kWay != Way::still && hearing.step_re != nullptr) {
      step_re = hn::Load(narrow, hearing.step_re + at);
      step_im = hn::Load(narrow, hearing.step_im + at);
      const Narrow middle = hn::Set(narrow, hearing.offset + static_cast<float>(kMomentMiddle));
      gain_re = hn::MulAdd(step_re, middle, gain_re);
      gain_im = hn::MulAdd(step_im, middle, gain_im);
      const Narrow scale = hn::Set(narrow, static_cast<float>(kMomentScale));
      step_re = hn::Mul(step_re, scale);
      step_im = hn::Mul(step_im, scale);
    }
    Narrow level_re = times_re(re, im, gain_re, gain_im), level_im = times_im(re, im, gain_re, gain_im);
    if constexpr (kWay == Way::still) {
      put(0, i, level_re, level_im);
    } else {
      Narrow slope_re = times_re(re, im, step_re, step_im), slope_im = times_im(re, im, step_re, step_im);
      if constexpr (kWay == Way::shifted) {
        const Complex s{hn::Load(tag, hearing.log_re + at), hn::Load(tag, hearing.log_im + at)};
        const Bend bend(hearing.bend, frames);
        const Narrow s_re = hn::DemoteTo(narrow, s.re), s_im = hn::DemoteTo(narrow, s.im);
        const auto by = [&](double c) HWY_ATTR { return hn::Set(narrow, static_cast<float>(c)); };
        const Narrow ahead_re = hn::MulAdd(s_re, by(bend.c0), by(1)), ahead_im = hn::Mul(s_im, by(bend.c0));
        const Narrow curve_re = times_re(level_re, level_im, s_re, s_im),
                     curve_im = times_im(level_re, level_im, s_re, s_im);  // s z g
        const Narrow new_re = times_re(level_re, level_im, ahead_re, ahead_im),
                     new_im = times_im(level_re, level_im, ahead_re, ahead_im);
        put(0, i, new_re, new_im);
        put(1, i, hn::MulAdd(curve_re, by(bend.c1), times_re(slope_re, slope_im, ahead_re, ahead_im)),
            hn::MulAdd(curve_im, by(bend.c1), times_im(slope_re, slope_im, ahead_re, ahead_im)));
        put(2, i, hn::Mul(curve_re, by(bend.c2)), hn::Mul(curve_im, by(bend.c2)));
        const Complex on{hn::Load(tag, group.on_re + i), hn::Load(tag, group.on_im + i)};
        store_states(multiply(z, on), modes, at);
        continue;
      } else {
        put(0, i, level_re, level_im);
        put(1, i, slope_re, slope_im);
      }
    }
    store_states(multiply(z, advance_of(modes, at, frames)), modes, at);
  }
}

template <Way kWay, std::size_t kOrders, Into kInto>
bool add_groups(const ModeArrays& modes, const MomentArrays& moments, ActiveGroups& active, std::size_t frames,
                const EnergyLimits& limits, std::span<const MomentTarget> targets, const float* level_and_slope) {
  HeardGroup<kOrders> group;
  std::size_t kept = 0;
  EnergyCheck check(limits);
  using Sums = HeardSums<kWay == Way::moving ? 1 : kOrders>;
  Sums sum;
  Outlet<kInto> outlet(targets);
  std::size_t here = kBands;  // none yet
  bool slopes = false;
  for (const MomentTarget& target : targets) slopes = slopes || target.slope != 0;
  for (std::size_t i = 0; i < active.count; ++i) {
    const std::uint32_t number = active.list[i];
    const std::size_t first = std::size_t{number} * kModePadding;
    check.begin_group();
    take_group<kWay>(modes, first, frames, check, group);
    if (!check.sane()) return false;
    active.list[kept] = number;
    kept += check.silent() ? 0 : 1;
    if (check.silent()) forget_states(modes, first);
    const std::uint16_t* const band = kWay == Way::shifted ? group.own_bands : moments.band + first;
    const float* const own_weights = kInto == Into::grid_as_lines ? moments.lines : moments.weights;
    const float* const weights = kWay == Way::shifted ? group.own_weights : own_weights + first * 2 * kMoments;
    for (std::size_t m = 0; m < kModePadding; ++m) {
      if (band[m] != here) {
        if (here != kBands) outlet.give(sum.moments(level_and_slope), here, slopes);
        sum = Sums();
        here = band[m];
      }
      if constexpr (kWay == Way::moving) {
        sum.add_lines(group.re + m, group.im + m, weights + m * 2 * kMoments);
      } else {
        sum.add(group.re + m, group.im + m, weights + m * 2 * kMoments);
      }
    }
  }
  if (here != kBands) outlet.give(sum.moments(level_and_slope), here, slopes);
  outlet.finish();
  active.count = kept;
  return true;
}

bool add_heard_moments_here(const ModeArrays& modes, const MomentArrays& moments, ActiveGroups& active,
                            std::size_t frames, const EnergyLimits& limits, const MomentTarget* targets,
                            std::size_t target_count, const float* level_and_slope) {
  const std::span<const MomentTarget> all(targets, target_count);
  const Hearing& hearing = *modes.hearing;
  const auto add = [&](auto* gather)
                       HWY_ATTR { return gather(modes, moments, active, frames, limits, all, level_and_slope); };
  const bool shifted = hearing.log_re != nullptr && (hearing.rate != 1 || hearing.bend != 0);
  const bool still = !shifted && hearing.step_re == nullptr;
  const Into into = where_to(all, still && moments.lines != nullptr && level_and_slope == nullptr);
  if (into == Into::grid_as_lines) return add(&add_groups<Way::still, 1, Into::grid_as_lines>);
  if (into == Into::grid) {
    if (shifted) return add(&add_groups<Way::shifted, 3, Into::grid>);
    return still ? add(&add_groups<Way::still, 1, Into::grid>) : add(&add_groups<Way::moving, 2, Into::grid>);
  }
  if (shifted) return add(&add_groups<Way::shifted, 3, Into::sums>);
  return still ? add(&add_groups<Way::still, 1, Into::sums>) : add(&add_groups<Way::moving, 2, Into::sums>);
}

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ringdown::synth {

HWY_EXPORT(add_heard_moments_here);

// Highway's dispatch reads an atomic, and indexes a table of functions, all of them in this file.
TRUST_REALTIME_BEGIN
bool add_heard_moments(const ModeArrays& modes, const MomentArrays& moments, ActiveGroups& active, std::size_t frames,
                       const EnergyLimits& limits, std::span<const MomentTarget> targets, Fade fade) REALTIME {
  const double per_frame = static_cast<double>(fade.to - fade.from) / static_cast<double>(frames);
  const float level_and_slope[2] = {static_cast<float>(static_cast<double>(fade.from) + per_frame * kMomentMiddle),
                                    static_cast<float>(per_frame * kMomentScale)};
  return HWY_DYNAMIC_DISPATCH(add_heard_moments_here)(modes, moments, active, frames, limits, targets.data(),
                                                      targets.size(), fade.none() ? nullptr : level_and_slope);
}
TRUST_REALTIME_END

}  // namespace ringdown::synth
#endif
