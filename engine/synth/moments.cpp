#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/synth/moments.cpp"
#include <hwy/foreach_target.h>  // compiles the rest of this file once per instruction set

#include <hwy/highway.h>

#include "engine/synth/moments.h"

#include "engine/synth/mode_vectors-inl.h"

#include <algorithm>
#include <cmath>
#include <numbers>

// A chunk by moments (moments.h derives the expansion)
//
// 1. add_moments_here() goes through the active groups, whose modes are in ascending order of bands but for groups that
// have come back. A mode's eight
//    moments are z times its eight complex weights. The sum over a band keeps the products with Re z and with Im z
//    apart, so a mode costs two multiply-adds on vectors of sixteen; they are combined into complex moments once, when
//    the band changes (BandMoments::give), and scaled by the gain of each output.
// 2. fill_spectrum_here() makes of the moments the spectra of eight sequences. A complex transform serves two channels:
//    the left one becomes its real part and the right one its imaginary part, because band k of a real signal stands at
//    the mirrored frequency, too, conjugate.
// 3. transform_here() transforms the eight sequences at once, one in each lane. Bands lie pi / kChunkFrames apart, so
//    the transform has twice as many points as the chunk has frames, and only its first half is wanted.
// 4. shape_here() multiplies moment p at frame j with q_p(t_j) and adds up over p: that is the sample.
//
// Moments, transform and shapes are float; the states are double and are moved on by p^frames as in mode_kernel.cpp.
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

// The moments of some modes of one band: what the real parts of their states give, and the imaginary ones.
class BandMoments {
 public:
  HWY_INLINE BandMoments() : by_re_(Pair::all(0)), by_im_(Pair::all(0)) {}
  HWY_INLINE void add(float z_re, float z_im, const float* weights) {
    const Pair weight = Pair::load(weights);
    by_re_ = multiply_add(Pair::all(z_re), weight, by_re_);
    by_im_ = multiply_add(Pair::all(z_im), weight, by_im_);
  }
  HWY_INLINE BandMoments& operator+=(const BandMoments& other) {
    by_re_ = by_re_ + other.by_re_, by_im_ = by_im_ + other.by_im_;
    return *this;
  }
  HWY_INLINE void give(std::span<const MomentTarget> targets, std::size_t band, const float* level_and_slope) const {
    alignas(64) static constexpr float kTurn[2 * kMoments] = {-1, -1, -1, -1, -1, -1, -1, -1, 1, 1, 1, 1, 1, 1, 1, 1};
    Pair moments = multiply_add(Pair::load(kTurn), by_im_.turned(), by_re_);
    if (level_and_slope) moments = faded(moments, level_and_slope[0], level_and_slope[1]);
    for (const MomentTarget& target : targets) {
      float* const sums = target.sums->of.data() + band * 2 * kMoments;
      multiply_add(Pair::all(target.gain), moments, Pair::load(sums)).store(sums);
    }
  }

 private:
  // Times level + slope t: as exp(delta t) is a sum of x^p q_p(t), t exp(delta t) is one of p x^(p-1) q_p(t).
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

// The states of a group as floats; looks at them and moves them on.
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

bool add_moments_here(const ModeArrays& modes, const MomentArrays& moments, ActiveGroups& active, std::size_t frames,
                      const EnergyLimits& limits, const MomentTarget* targets, std::size_t target_count,
                      const float* level_and_slope) {
  alignas(64) float re[kModePadding], im[kModePadding];
  const std::span<const MomentTarget> all(targets, target_count);
  std::size_t kept = 0;
  EnergyCheck check(limits);
  BandMoments sum;
  std::uint16_t here = active.count > 0 ? moments.band[std::size_t{active.list[0]} * kModePadding] : std::uint16_t{0};
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
    const float* const weights = moments.weights + first * 2 * kMoments;
    const auto change_to = [&](std::uint16_t next) HWY_ATTR {
      if (next == here) return;
      sum.give(all, here, level_and_slope);
      sum = BandMoments();
      here = next;
    };
    if (band[0] == band[kModePadding - 1]) {
      change_to(band[0]);
      BandMoments odd;  // two sums, so that additions need not wait for each other
      for (std::size_t m = 0; m < kModePadding; m += 2) {
        sum.add(re[m], im[m], weights + m * 2 * kMoments);
        odd.add(re[m + 1], im[m + 1], weights + (m + 1) * 2 * kMoments);
      }
      sum += odd;
    } else {
      for (std::size_t m = 0; m < kModePadding; ++m) {
        change_to(band[m]);
        sum.add(re[m], im[m], weights + m * 2 * kMoments);
      }
    }
  }
  if (active.count > 0) sum.give(all, here, level_and_slope);
  active.count = kept;
  return true;
}

// Four neighbours of a butterfly's legs, complex.
struct Legs {
  Eight ar, br, cr, dr, ai, bi, ci, di;
  HWY_INLINE Legs(const float* re, const float* im, std::size_t next)
      : ar(Eight::load(re)),
        br(Eight::load(re + next)),
        cr(Eight::load(re + 2 * next)),
        dr(Eight::load(re + 3 * next)),
        ai(Eight::load(im)),
        bi(Eight::load(im + next)),
        ci(Eight::load(im + 2 * next)),
        di(Eight::load(im + 3 * next)) {}
};

// kWindow-point transform of kMoments sequences at once, in place, exp(+2 pi i j k / kWindow); frame j ends at the
// place of j with its base-4 digits turned round. Only frames below `frames`, at most half of the window, are found.
// Source: the radix-4 decimation in frequency of every textbook.
void transform_here(float* re, float* im, const float* cosine, const float* sine, std::size_t window,
                    std::size_t frames) {
  for (std::size_t size = window; size > 4; size /= 4) {
    const std::size_t quarter = size / 4, step = window / size, next = quarter * kMoments;
    for (std::size_t j = 0; j < quarter; ++j) {
      const Eight c1 = Eight::all(cosine[j * step]), s1 = Eight::all(sine[j * step]);
      const Eight c2 = Eight::all(cosine[2 * j * step]), s2 = Eight::all(sine[2 * j * step]);
      const Eight c3 = Eight::all(cosine[3 * j * step]), s3 = Eight::all(sine[3 * j * step]);
      for (std::size_t start = j; start < window; start += size) {
        float* const r = re + start * kMoments;
        float* const i = im + start * kMoments;
        const Legs leg(r, i, next);
        const Eight even_r = leg.ar + leg.cr, even_i = leg.ai + leg.ci, odd_r = leg.br + leg.dr,
                    odd_i = leg.bi + leg.di;
        const Eight half_r = leg.ar - leg.cr, half_i = leg.ai - leg.ci;
        const Eight turn_r = leg.di - leg.bi, turn_i = leg.br - leg.dr;  // i (b - d)
        (even_r + odd_r).store(r);
        (even_i + odd_i).store(i);
        const auto turned = [&](Eight x, Eight y, Eight c, Eight s, std::size_t at) HWY_ATTR {
          subtract_product(y, s, x * c).store(r + at);
          multiply_add(x, s, y * c).store(i + at);
        };
        turned(half_r + turn_r, half_i + turn_i, c1, s1, next);
        turned(even_r - odd_r, even_i - odd_i, c2, s2, 2 * next);
        turned(half_r - turn_r, half_i - turn_i, c3, s3, 3 * next);
      }
    }
  }
  // The last butterflies need no turning, and their second legs begin a quarter of the window, the others half of it.
  const bool all = frames > window / 4;
  for (std::size_t start = 0; start < window * kMoments; start += 4 * kMoments) {
    float* const r = re + start;
    float* const i = im + start;
    const Legs leg(r, i, kMoments);
    ((leg.ar + leg.cr) + (leg.br + leg.dr)).store(r);
    ((leg.ai + leg.ci) + (leg.bi + leg.di)).store(i);
    if (!all) continue;
    ((leg.ar - leg.cr) + (leg.di - leg.bi)).store(r + kMoments);
    ((leg.ai - leg.ci) + (leg.br - leg.dr)).store(i + kMoments);
  }
}

// Spectrum of left + i right, both real in time: half of each band, and the conjugate at the mirrored frequency.
void fill_spectrum_here(const float* left, const float* right, float* re, float* im) {
  constexpr std::size_t kWindow = 2 * kChunkFrames;
  const Eight half = Eight::all(0.5f), none = Eight::all(0);
  for (std::size_t k = 0; k < kBands; ++k, left += 2 * kMoments, right += 2 * kMoments) {
    const Eight lr = Eight::load(left), rr = Eight::load(right);
    const bool end = k == 0 || k == kBands - 1;
    const Eight li = end ? none : Eight::load(left + kMoments), ri = end ? none : Eight::load(right + kMoments);
    const Eight scale = end ? Eight::all(1) : half;
    (scale * (lr - ri)).store(re + k * kMoments);
    (scale * (li + rr)).store(im + k * kMoments);
    if (end) continue;
    (scale * (lr + ri)).store(re + (kWindow - k) * kMoments);
    (scale * (rr - li)).store(im + (kWindow - k) * kMoments);
  }
}

void shape_here(const float* values, const std::uint16_t* place, const float* shape, double* out, std::size_t frames) {
  for (std::size_t j = 0; j < frames; ++j) {
    out[j] +=
        static_cast<double>((Eight::load(values + place[j] * kMoments) * Eight::load(shape + j * kMoments)).sum());
  }
}

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ringdown::synth {

HWY_EXPORT(add_moments_here);
HWY_EXPORT(transform_here);
HWY_EXPORT(fill_spectrum_here);
HWY_EXPORT(shape_here);

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHalf = 0.5 * static_cast<double>(kChunkFrames);  // frames from the middle of the window to its end
constexpr double kMiddle = kHalf - 0.5;                            // frame at t = 0
constexpr double kMaxWidth = kPi / 4;                              // |imaginary part of delta| within a band
constexpr double kDecay = 0.2;  // decay over half a window about which is expanded: modes with up to twice as much

double band_centre(std::uint16_t band) { return band * kPi / static_cast<double>(kChunkFrames); }

std::complex<double> delta_of(std::complex<double> s) {
  return (s - std::complex<double>(0, band_centre(band_of(s)))) * kHalf;
}

// Coefficients of x^0 ... of the Chebyshev polynomial T_n.
std::array<double, kMoments> chebyshev(std::size_t n) {
  std::array<double, kMoments> before{}, now{};
  before[0] = 1, now[1] = 1;
  if (n == 0) return before;
  for (std::size_t k = 1; k < n; ++k) {
    std::array<double, kMoments> next{};
    for (std::size_t m = 0; m + 1 < kMoments; ++m) next[m + 1] = 2 * now[m];
    for (std::size_t m = 0; m < kMoments; ++m) next[m] -= before[m];
    before = now, now = next;
  }
  return now;
}

// q_p(t): exp(x t) = sum of e_n i^n J_n(a t) T_n(x / (i a)), e_0 = 1, e_n = 2; i^n T_n(x / (i a)) is real in x.
std::array<double, kMoments> shapes_at(double t) {
  std::array<double, kMoments> q{};
  for (std::size_t n = 0; n < kMoments; ++n) {
    const double sign = n % 2 == 1 && t < 0 ? -1 : 1;  // J_n of a negative number
    const double bessel = sign * std::cyl_bessel_j(static_cast<double>(n), kMaxWidth * std::abs(t));
    const std::array<double, kMoments> polynomial = chebyshev(n);
    for (std::size_t m = n % 2; m <= n; m += 2) {
      const double turned = (n - m) / 2 % 2 == 0 ? 1 : -1;  // i^n / i^m
      q[m] += (n == 0 ? 1 : 2) * bessel * polynomial[m] * turned / std::pow(kMaxWidth, static_cast<double>(m));
    }
  }
  for (double& value : q) value *= std::exp(-kDecay * t);
  return q;
}

}  // namespace

bool takes_moments(std::complex<double> s) {
  return s.real() <= 0 && -s.real() * kHalf <= 2 * kDecay && s.imag() >= 0 && s.imag() < kPi;
}

std::uint16_t band_of(std::complex<double> s) {
  return static_cast<std::uint16_t>(std::lround(s.imag() * static_cast<double>(kChunkFrames) / kPi));
}

std::array<float, 2 * kMoments> moment_weights(std::complex<double> s) {
  const std::complex<double> delta = delta_of(s);
  std::complex<double> weight = std::exp(delta * (kMiddle / kHalf));  // from the window's first frame to its middle
  std::array<float, 2 * kMoments> weights{};
  for (std::size_t p = 0; p < kMoments; ++p, weight *= delta + kDecay) {
    weights[p] = static_cast<float>(weight.real());
    weights[kMoments + p] = static_cast<float>(weight.imag());
  }
  return weights;
}

// Highway's dispatch reads an atomic, and indexes a table of functions, all of them in this file.
RINGDOWN_TRUST_REALTIME_BEGIN
bool add_moments(const ModeArrays& modes, const MomentArrays& moments, ActiveGroups& active, std::size_t frames,
                 const EnergyLimits& limits, std::span<const MomentTarget> targets, Fade fade) RINGDOWN_REALTIME {
  // Frame j is at t = (j - kMiddle) / kHalf.
  const double per_frame = static_cast<double>(fade.to - fade.from) / static_cast<double>(frames);
  const float level_and_slope[2] = {static_cast<float>(static_cast<double>(fade.from) + per_frame * kMiddle),
                                    static_cast<float>(per_frame * kHalf)};
  return HWY_DYNAMIC_DISPATCH(add_moments_here)(modes, moments, active, frames, limits, targets.data(), targets.size(),
                                                fade.none() ? nullptr : level_and_slope);
}
RINGDOWN_TRUST_REALTIME_END

MomentSynthesis::MomentSynthesis() : re_{}, im_{} {
  for (std::size_t k = 0; k < kWindow; ++k) {
    const double angle = 2 * kPi * static_cast<double>(k) / static_cast<double>(kWindow);
    cosine_[k] = static_cast<float>(std::cos(angle));
    sine_[k] = static_cast<float>(std::sin(angle));
  }
  for (std::size_t j = 0; j < kChunkFrames; ++j) {
    const std::array<double, kMoments> q = shapes_at((static_cast<double>(j) - kMiddle) / kHalf);
    for (std::size_t p = 0; p < kMoments; ++p) shape_[j * kMoments + p] = static_cast<float>(q[p]);
    std::size_t turned = 0;
    for (std::size_t digits = kWindow, rest = j; digits > 1; digits /= 4, rest /= 4) turned = 4 * turned + rest % 4;
    place_[j] = static_cast<std::uint16_t>(turned);
  }
}

RINGDOWN_TRUST_REALTIME_BEGIN
void MomentSynthesis::add(const MomentSums& left, const MomentSums& right, double* out_left, double* out_right,
                          std::size_t frames) RINGDOWN_REALTIME {
  HWY_DYNAMIC_DISPATCH(fill_spectrum_here)(left.of.data(), right.of.data(), re_.data(), im_.data());
  HWY_DYNAMIC_DISPATCH(transform_here)(re_.data(), im_.data(), cosine_.data(), sine_.data(), kWindow, frames);
  HWY_DYNAMIC_DISPATCH(shape_here)(re_.data(), place_.data(), shape_.data(), out_left, frames);
  HWY_DYNAMIC_DISPATCH(shape_here)(im_.data(), place_.data(), shape_.data(), out_right, frames);
}
RINGDOWN_TRUST_REALTIME_END

}  // namespace ringdown::synth
#endif
