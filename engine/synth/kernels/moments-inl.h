#include <hwy/highway.h>

#include "engine/synth/kernels/moments.h"

#include "engine/synth/kernels/moment_vectors-inl.h"

#include <algorithm>
#include <cmath>
#include <numbers>

// A chunk by moments (moments.h derives the expansion)
//
// add_moments_here() goes through the active groups, whose modes are in ascending order of bands, except for groups
// that have come back. A mode's eight moments are z times its eight complex weights. The sum over a band keeps the
// products with Re z and with Im z apart, so a mode costs two multiply-adds on vectors of sixteen. They are combined
// into complex moments once, when the band changes (BandMoments::moments), and scaled by the gain of each output.
//
// Moments are float. The states are double and are moved on by p^frames as in mode_kernel-inl.h. Modes with individual
// gains are handled in heard_moments-inl.h, and moment_synthesis-inl.h turns the sums into samples.
HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

// The moments of some modes of one band: those from the real parts of their states, and those from the imaginary parts.
class BandMoments {
 public:
  HWY_INLINE BandMoments() : by_re_(Pair::all(0)), by_im_(Pair::all(0)) {}
  HWY_INLINE BandMoments(float z_re, float z_im, const float* weights)
      : by_re_(Pair::all(z_re) * Pair::load(weights)), by_im_(Pair::all(z_im) * Pair::load(weights)) {}
  HWY_INLINE void add(float z_re, float z_im, const float* weights) {
    const Pair weight = Pair::load(weights);
    by_re_ = multiply_add(Pair::all(z_re), weight, by_re_);
    by_im_ = multiply_add(Pair::all(z_im), weight, by_im_);
  }
  HWY_INLINE BandMoments& operator+=(const BandMoments& other) {
    by_re_ = by_re_ + other.by_re_;
    by_im_ = by_im_ + other.by_im_;
    return *this;
  }
  [[nodiscard]] HWY_INLINE Pair moments(const float* level_and_slope) const {
    alignas(64) static constexpr float kTurn[2 * kMoments] = {-1, -1, -1, -1, -1, -1, -1, -1, 1, 1, 1, 1, 1, 1, 1, 1};
    const Pair moments = multiply_add(Pair::load(kTurn), by_im_.turned(), by_re_);
    return level_and_slope ? faded(moments, level_and_slope[0], level_and_slope[1]) : moments;
  }

 private:
  // Returns the moments times level + slope t: as exp(delta t) is a sum of x^p q_p(t), t exp(delta t) is a sum of p
  // x^(p-1) q_p(t).
  static Pair faded(Pair moments, float level, float slope) {
    alignas(64) float from[2 * kMoments], to[2 * kMoments];
    moments.store(from);
    for (std::size_t i = 0; i < 2 * kMoments; ++i) {
      const std::size_t p = i % kMoments;
      to[i] = level * from[i] + (p > 0 ? slope * static_cast<float>(p) * from[i - 1] : 0.0f);
    }
    return Pair::load(to);
  }
  Pair by_re_, by_im_;
};

// Reads the states of a group as floats, checks them, and moves them on.
HWY_INLINE void take_states(const ModeArrays& modes, std::size_t first, std::size_t frames, float* re, float* im,
                            EnergyCheck& check) {
  const Tag tag;
  const hn::CappedTag<float, hn::MaxLanes(tag)> narrow;
  const std::size_t lanes = hn::Lanes(tag);
  RINGDOWN_UNROLL
  for (std::size_t i = 0; i < kModePadding; i += lanes) {
    const Complex z = load_states(modes, first + i);
    check.look_at(z);
    hn::Store(hn::DemoteTo(narrow, z.re), narrow, re + i);
    hn::Store(hn::DemoteTo(narrow, z.im), narrow, im + i);
    store_states(multiply(z, advance_of(modes, first + i, frames)), modes, first + i);
  }
}

// Sums one band after another, and gives each sum to the outlet when the next band begins.
template <Into kInto>
class RunningBand {
 public:
  HWY_INLINE RunningBand(Outlet<kInto>& outlet, std::uint16_t band, const float* level_and_slope)
      : outlet_(outlet), level_and_slope_(level_and_slope), band_(band) {}
  HWY_INLINE BandMoments& of(std::uint16_t band) {
    if (band == band_) return sum_;
    give();
    sum_ = BandMoments();
    band_ = band;
    return sum_;
  }
  HWY_INLINE void give() { outlet_.give(sum_.moments(level_and_slope_), band_, false); }

 private:
  Outlet<kInto>& outlet_;
  const float* level_and_slope_;
  BandMoments sum_;
  std::uint16_t band_;
};

// Modes of a group that spans this many bands, or more, are given to the targets one by one: most are alone in their
// bands.
constexpr int kWideGroup = 4;

template <Into kInto>
bool add_plain_groups(const ModeArrays& modes, const MomentArrays& moments, ActiveGroups& active, std::size_t frames,
                      const EnergyLimits& limits, std::span<const MomentTarget> targets, const float* level_and_slope) {
  alignas(64) float re[kModePadding], im[kModePadding];
  Outlet<kInto> outlet(targets);
  std::size_t kept = 0;
  EnergyCheck check(limits);
  RunningBand<kInto> running(
      outlet, active.count > 0 ? moments.band[std::size_t{active.list[0]} * kModePadding] : std::uint16_t{0},
      level_and_slope);
  for (std::size_t i = 0; i < active.count; ++i) {
    const std::uint32_t group = active.list[i];
    const std::size_t first = std::size_t{group} * kModePadding;
    check.begin_group();
    take_states(modes, first, frames, re, im, check);
    if (!check.sane()) return false;
    active.list[kept] = group;
    kept += check.silent() ? 0 : 1;
    if (check.silent()) forget_states(modes, first);
    const std::uint16_t* const band = moments.band + first;
    const float* const weights =
        (kInto == Into::grid_as_lines ? moments.lines : moments.weights) + first * 2 * kMoments;
    if (band[0] == band[kModePadding - 1]) {
      BandMoments& sum = running.of(band[0]);
      BandMoments odd;  // two sums, so that additions do not wait for each other
      for (std::size_t m = 0; m < kModePadding; m += 2) {
        sum.add(re[m], im[m], weights + m * 2 * kMoments);
        odd.add(re[m + 1], im[m + 1], weights + (m + 1) * 2 * kMoments);
      }
      sum += odd;
    } else if (!Outlet<kInto>::kToGrid && band[kModePadding - 1] - band[0] >= kWideGroup) {
      for (std::size_t m = 0; m < kModePadding; ++m) {
        const BandMoments alone(re[m], im[m], weights + m * 2 * kMoments);
        outlet.give(alone.moments(level_and_slope), band[m], false);
      }
    } else {
      for (std::size_t m = 0; m < kModePadding; ++m) {
        running.of(band[m]).add(re[m], im[m], weights + m * 2 * kMoments);
      }
    }
  }
  if (active.count > 0) running.give();
  outlet.finish();
  active.count = kept;
  return true;
}

bool add_moments_here(const ModeArrays& modes, const MomentArrays& moments, ActiveGroups& active, std::size_t frames,
                      const EnergyLimits& limits, const MomentTarget* targets, std::size_t target_count,
                      const float* level_and_slope) {
  const std::span<const MomentTarget> all(targets, target_count);
  const auto add = [&](auto* gather)
                       HWY_ATTR { return gather(modes, moments, active, frames, limits, all, level_and_slope); };
  const Into into = where_to(all, moments.lines != nullptr && level_and_slope == nullptr);
  if (into == Into::sums && target_count == 1) return add(&add_plain_groups<Into::one_sum>);
  if (into == Into::sums) return add(&add_plain_groups<Into::sums>);
  return into == Into::grid ? add(&add_plain_groups<Into::grid>) : add(&add_plain_groups<Into::grid_as_lines>);
}

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ringdown::synth {

HWY_EXPORT(add_moments_here);

namespace {

double band_centre(std::uint16_t band) { return band * std::numbers::pi / static_cast<double>(kChunkFrames); }

std::complex<double> delta_of(std::complex<double> s) {
  return (s - std::complex<double>(0, band_centre(band_of(s)))) * kMomentScale;
}
}  // namespace

bool takes_moments(std::complex<double> s) {
  return s.real() <= 0 && -s.real() * kMomentScale <= 2 * kMomentDecay && s.imag() >= 0 && s.imag() < std::numbers::pi;
}

std::uint16_t band_of(std::complex<double> s) {
  return static_cast<std::uint16_t>(std::lround(s.imag() * static_cast<double>(kChunkFrames) / std::numbers::pi));
}

std::array<std::complex<double>, kMoments> exact_moment_weights(std::complex<double> s) {
  const std::complex<double> delta = delta_of(s);
  std::complex<double> weight =
      std::exp(delta * (kMomentMiddle / kMomentScale));  // from the window's first frame to its middle
  std::array<std::complex<double>, kMoments> weights;
  for (std::size_t p = 0; p < kMoments; ++p, weight *= delta + kMomentDecay) weights[p] = weight;
  return weights;
}

std::array<float, 2 * kMoments> moment_weights(std::complex<double> s) {
  const std::array<std::complex<double>, kMoments> exact = exact_moment_weights(s);
  std::array<float, 2 * kMoments> weights{};
  for (std::size_t p = 0; p < kMoments; ++p) {
    weights[p] = static_cast<float>(exact[p].real());
    weights[kMoments + p] = static_cast<float>(exact[p].imag());
  }
  return weights;
}

// Highway's dispatch reads an atomic, and indexes a table of functions, all of them in this file.
TRUST_REALTIME_BEGIN
bool add_moments(const ModeArrays& modes, const MomentArrays& moments, ActiveGroups& active, std::size_t frames,
                 const EnergyLimits& limits, std::span<const MomentTarget> targets, Fade fade) REALTIME {
  if (modes.hearing != nullptr) return add_heard_moments(modes, moments, active, frames, limits, targets, fade);
  const auto add = [&](const float* level_and_slope) REALTIME {
    return HWY_DYNAMIC_DISPATCH(add_moments_here)(modes, moments, active, frames, limits, targets.data(),
                                                  targets.size(), level_and_slope);
  };
  if (fade.none()) return add(nullptr);
  // Frame j is at t = (j - kMomentMiddle) / kMomentScale.
  const double per_frame = static_cast<double>(fade.to - fade.from) / static_cast<double>(frames);
  const float level_and_slope[2] = {static_cast<float>(static_cast<double>(fade.from) + per_frame * kMomentMiddle),
                                    static_cast<float>(per_frame * kMomentScale)};
  return add(level_and_slope);
}
TRUST_REALTIME_END

}  // namespace ringdown::synth
#endif
