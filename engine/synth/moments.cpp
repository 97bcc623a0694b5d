#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/synth/moments.cpp"
#include <hwy/foreach_target.h>  // compiles the rest of this file once per instruction set

#include <hwy/highway.h>

#include "engine/synth/moments.h"

#include "engine/synth/mode_vectors-inl.h"

#include <algorithm>
#include <cmath>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// kMoments numbers, in as few vectors as the instruction set allows.
struct Eight {
  using Tag = hn::CappedTag<float, kMoments>;
  static constexpr std::size_t kLanes = hn::MaxLanes(Tag()), kVectors = kMoments / kLanes;
  hn::Vec<Tag> part[kVectors];

  template <class Do>
  HWY_INLINE static Eight make(Do&& act) {
    Eight result;
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) result.part[v] = act(v);
    return result;
  }
  HWY_INLINE static Eight load(const float* from) {
    return make([from](std::size_t v) HWY_ATTR { return hn::Load(Tag(), from + v * kLanes); });
  }
  HWY_INLINE static Eight all(float value) {
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
  friend HWY_INLINE Eight operator+(Eight a, Eight b) {
    return make([&](std::size_t v) HWY_ATTR { return hn::Add(a.part[v], b.part[v]); });
  }
  friend HWY_INLINE Eight operator-(Eight a, Eight b) {
    return make([&](std::size_t v) HWY_ATTR { return hn::Sub(a.part[v], b.part[v]); });
  }
  friend HWY_INLINE Eight operator*(Eight a, Eight b) {
    return make([&](std::size_t v) HWY_ATTR { return hn::Mul(a.part[v], b.part[v]); });
  }
  friend HWY_INLINE Eight multiply_add(Eight a, Eight b, Eight c) {  // a b + c
    return make([&](std::size_t v) HWY_ATTR { return hn::MulAdd(a.part[v], b.part[v], c.part[v]); });
  }
  friend HWY_INLINE Eight subtract_product(Eight a, Eight b, Eight c) {  // c - a b
    return make([&](std::size_t v) HWY_ATTR { return hn::NegMulAdd(a.part[v], b.part[v], c.part[v]); });
  }
};

// The moments of some modes of one band. The four products of complex numbers are summed apart: a sum waits for itself
// only once per mode.
class BandMoments {
 public:
  HWY_INLINE BandMoments(float z_re, float z_im, const float* weights) {
    const Eight x = Eight::all(z_re), y = Eight::all(z_im);
    const Eight w_re = Eight::load(weights), w_im = Eight::load(weights + kMoments);
    re_re_ = x * w_re, im_im_ = y * w_im, re_im_ = x * w_im, im_re_ = y * w_re;
  }
  HWY_INLINE void add(float z_re, float z_im, const float* weights) {
    const Eight x = Eight::all(z_re), y = Eight::all(z_im);
    const Eight w_re = Eight::load(weights), w_im = Eight::load(weights + kMoments);
    re_re_ = multiply_add(x, w_re, re_re_);
    im_im_ = multiply_add(y, w_im, im_im_);
    re_im_ = multiply_add(x, w_im, re_im_);
    im_re_ = multiply_add(y, w_re, im_re_);
  }
  // Times level + slope t: as exp(delta t) is a sum of x^p q_p(t), t exp(delta t) is one of p x^(p-1) q_p(t).
  HWY_INLINE void fade(float level, float slope) {
    const Eight re = re_re_ - im_im_, im = re_im_ + im_re_;
    const Eight a = Eight::all(level);
    re_re_ = multiply_add(a, re, derivative(re, slope)), re_im_ = multiply_add(a, im, derivative(im, slope));
    im_im_ = im_re_ = Eight::all(0);
  }
  HWY_INLINE void give(std::span<const MomentTarget> targets, std::size_t band) const {
    const Eight re = re_re_ - im_im_, im = re_im_ + im_re_;
    for (const MomentTarget& target : targets) {
      float* const sums = target.sums->of.data() + band * 2 * kMoments;
      const Eight gain = Eight::all(target.gain);
      multiply_add(gain, re, Eight::load(sums)).store(sums);
      multiply_add(gain, im, Eight::load(sums + kMoments)).store(sums + kMoments);
    }
  }

 private:
  HWY_INLINE static Eight derivative(Eight moments, float slope) {
    alignas(64) float from[kMoments], to[kMoments];
    moments.store(from);
    to[0] = 0;
    for (std::size_t p = 1; p < kMoments; ++p) to[p] = slope * static_cast<float>(p) * from[p - 1];
    return Eight::load(to);
  }
  Eight re_re_, im_im_, re_im_, im_re_;
};

// The states of a group as floats; moves them on; returns their energy before.
HWY_INLINE double take_states(const ModeArrays& modes, std::size_t first, std::size_t frames, float* re, float* im) {
  const Tag tag;
  const hn::CappedTag<float, hn::MaxLanes(tag)> narrow;
  const std::size_t lanes = hn::Lanes(tag);
  Vec energy = hn::Zero(tag);
  RINGDOWN_UNROLL
  for (std::size_t i = 0; i < kModePadding; i += lanes) {
    const Complex z = load_states(modes, first + i);
    energy = hn::Add(energy, norm(z));
    hn::Store(hn::DemoteTo(narrow, z.re), narrow, re + i);
    hn::Store(hn::DemoteTo(narrow, z.im), narrow, im + i);
    store_states(multiply(z, advance_of(modes, first + i, frames)), modes, first + i);
  }
  return hn::GetLane(hn::SumOfLanes(tag, energy));
}

double add_moments_here(const ModeArrays& modes, const MomentArrays& moments, ActiveGroups& active, std::size_t frames,
                        const EnergyLimits& limits, const MomentTarget* targets, std::size_t target_count,
                        const float* level_and_slope) {
  alignas(64) float re[kModePadding], im[kModePadding];
  const std::span<const MomentTarget> all(targets, target_count);
  double total = 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < active.count; ++i) {
    const std::uint32_t group = active.list[i];
    const std::size_t first = std::size_t{group} * kModePadding;
    const double energy = take_states(modes, first, frames, re, im);
    total += energy;
    if (!(total <= limits.most)) return total;
    active.list[kept] = group;
    kept += energy <= limits.floor ? 0 : 1;
    if (energy <= limits.floor) forget_states(modes, first);
    const std::uint16_t* const band = moments.band + first;
    const float* weights = moments.weights + first * 2 * kMoments;
    for (std::size_t m = 0; m < kModePadding;) {
      const std::uint16_t here = band[m];
      BandMoments sum(re[m], im[m], weights);
      while (++m < kModePadding && band[m] == here) {
        weights += 2 * kMoments;
        sum.add(re[m], im[m], weights);
      }
      weights += 2 * kMoments;
      if (level_and_slope) sum.fade(level_and_slope[0], level_and_slope[1]);
      sum.give(all, here);
    }
  }
  active.count = kept;
  return total;
}

// kWindow-point transform of kMoments sequences at once, in place, exp(+2 pi i j k / kWindow); frame j ends at the
// place of j with its base-4 digits turned round. Source: the radix-4 decimation in frequency of every textbook.
void transform_here(float* re, float* im, const float* cosine, const float* sine, std::size_t window) {
  for (std::size_t size = window; size > 1; size /= 4) {
    const std::size_t quarter = size / 4, step = window / size;
    for (std::size_t j = 0; j < quarter; ++j) {
      const Eight c1 = Eight::all(cosine[j * step]), s1 = Eight::all(sine[j * step]);
      const Eight c2 = Eight::all(cosine[2 * j * step]), s2 = Eight::all(sine[2 * j * step]);
      const Eight c3 = Eight::all(cosine[3 * j * step]), s3 = Eight::all(sine[3 * j * step]);
      for (std::size_t start = j; start < window; start += size) {
        float* const r = re + start * kMoments;
        float* const i = im + start * kMoments;
        const std::size_t next = quarter * kMoments;
        const Eight ar = Eight::load(r), br = Eight::load(r + next), cr = Eight::load(r + 2 * next),
                    dr = Eight::load(r + 3 * next);
        const Eight ai = Eight::load(i), bi = Eight::load(i + next), ci = Eight::load(i + 2 * next),
                    di = Eight::load(i + 3 * next);
        const Eight even_r = ar + cr, even_i = ai + ci, odd_r = br + dr, odd_i = bi + di;
        const Eight half_r = ar - cr, half_i = ai - ci, turn_r = di - bi, turn_i = br - dr;  // i (b - d)
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
constexpr double kWidest = kPi / 4;                                // |imaginary part of delta| within a band
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
    const double bessel = sign * std::cyl_bessel_j(static_cast<double>(n), kWidest * std::abs(t));
    const std::array<double, kMoments> polynomial = chebyshev(n);
    for (std::size_t m = n % 2; m <= n; m += 2) {
      const double turned = (n - m) / 2 % 2 == 0 ? 1 : -1;  // i^n / i^m
      q[m] += (n == 0 ? 1 : 2) * bessel * polynomial[m] * turned / std::pow(kWidest, static_cast<double>(m));
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
double add_moments(const ModeArrays& modes, const MomentArrays& moments, ActiveGroups& active, std::size_t frames,
                   const EnergyLimits& limits, std::span<const MomentTarget> targets, Fade fade) RINGDOWN_REALTIME {
  // Frame j is at t = (j - kMiddle) / kHalf.
  const double per_frame = static_cast<double>(fade.to - fade.from) / static_cast<double>(frames);
  const float level_and_slope[2] = {static_cast<float>(static_cast<double>(fade.from) + per_frame * kMiddle),
                                    static_cast<float>(per_frame * kHalf)};
  return HWY_DYNAMIC_DISPATCH(add_moments_here)(modes, moments, active, frames, limits, targets.data(), targets.size(),
                                                fade.none() ? nullptr : level_and_slope);
}

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

void MomentSynthesis::add(const MomentSums& left, const MomentSums& right, double* out_left, double* out_right,
                          std::size_t frames) RINGDOWN_REALTIME {
  HWY_DYNAMIC_DISPATCH(fill_spectrum_here)(left.of.data(), right.of.data(), re_.data(), im_.data());
  HWY_DYNAMIC_DISPATCH(transform_here)(re_.data(), im_.data(), cosine_.data(), sine_.data(), kWindow);
  HWY_DYNAMIC_DISPATCH(shape_here)(re_.data(), place_.data(), shape_.data(), out_left, frames);
  HWY_DYNAMIC_DISPATCH(shape_here)(im_.data(), place_.data(), shape_.data(), out_right, frames);
}
RINGDOWN_TRUST_REALTIME_END

}  // namespace ringdown::synth
#endif
