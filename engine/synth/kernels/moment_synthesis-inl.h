#include <hwy/highway.h>

#include "engine/synth/kernels/moments.h"

#include "engine/synth/kernels/moment_vectors-inl.h"

#include <cmath>
#include <numbers>

// From moments to samples (moments.h derives the expansion)
//
// 1. fill_spectrum_here() turns the moments into the spectra of eight sequences. A complex transform serves two
//    channels: the left one becomes its real part and the right one its imaginary part, because band k of a real signal
//    also appears at the mirrored frequency, conjugated.
// 2. transform_here() transforms the eight sequences at once, one in each lane. Bands lie pi / kChunkFrames apart, so
//    the transform has twice as many points as the chunk has frames, and only its first half is used.
// 3. shape_here() multiplies moment p at frame j by q_p(t_j) and sums over p, which gives the sample.
HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

// Four adjacent values of each leg of a butterfly, complex.
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
// index of j with its base-4 digits reversed. Only frames below `frames`, at most half of the window, are computed.
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
  // The last butterflies need no twiddle factors. Their second legs begin at a quarter of the window, the others at
  // half of it.
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

HWY_EXPORT(transform_here);
HWY_EXPORT(fill_spectrum_here);
HWY_EXPORT(shape_here);

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHalf = kMomentScale, kMiddle = kMomentMiddle, kDecay = kMomentDecay;
constexpr double kMaxWidth = kPi / 4;  // |imaginary part of delta| within a band

// Coefficients of x^0 ... of the Chebyshev polynomial T_n.
std::array<double, kMoments> chebyshev(std::size_t n) {
  std::array<double, kMoments> before{}, now{};
  before[0] = 1;
  now[1] = 1;
  if (n == 0) return before;
  for (std::size_t k = 1; k < n; ++k) {
    std::array<double, kMoments> next{};
    for (std::size_t m = 0; m + 1 < kMoments; ++m) next[m + 1] = 2 * now[m];
    for (std::size_t m = 0; m < kMoments; ++m) next[m] -= before[m];
    before = now;
    now = next;
  }
  return now;
}

}  // namespace

// q_p(t): exp(x t) = sum of e_n i^n J_n(a t) T_n(x / (i a)), e_0 = 1, e_n = 2; i^n T_n(x / (i a)) is real in x.
std::array<double, kMoments> moment_shapes(double t) {
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

ChunkTransform::ChunkTransform() {
  for (std::size_t k = 0; k < kPoints; ++k) {
    const double angle = 2 * kPi * static_cast<double>(k) / static_cast<double>(kPoints);
    cosine_[k] = static_cast<float>(std::cos(angle));
    sine_[k] = static_cast<float>(std::sin(angle));
  }
  for (std::size_t j = 0; j < kChunkFrames; ++j) {
    std::size_t turned = 0;
    for (std::size_t digits = kPoints, rest = j; digits > 1; digits /= 4, rest /= 4) turned = 4 * turned + rest % 4;
    places_[j] = static_cast<std::uint16_t>(turned);
  }
}

MomentSynthesis::MomentSynthesis() : re_{}, im_{} {
  for (std::size_t j = 0; j < kChunkFrames; ++j) {
    const std::array<double, kMoments> q = moment_shapes((static_cast<double>(j) - kMiddle) / kHalf);
    for (std::size_t p = 0; p < kMoments; ++p) shape_[j * kMoments + p] = static_cast<float>(q[p]);
  }
}

TRUST_REALTIME_BEGIN
void ChunkTransform::run(float* re, float* im, std::size_t frames) const REALTIME {
  HWY_DYNAMIC_DISPATCH(transform_here)(re, im, cosine_.data(), sine_.data(), kPoints, frames);
}

void MomentSynthesis::add(const MomentSums& left, const MomentSums& right, double* out_left, double* out_right,
                          std::size_t frames) REALTIME {
  HWY_DYNAMIC_DISPATCH(fill_spectrum_here)(left.of.data(), right.of.data(), re_.data(), im_.data());
  transform_.run(re_.data(), im_.data(), frames);
  HWY_DYNAMIC_DISPATCH(shape_here)(re_.data(), transform_.places(), shape_.data(), out_left, frames);
  HWY_DYNAMIC_DISPATCH(shape_here)(im_.data(), transform_.places(), shape_.data(), out_right, frames);
}
TRUST_REALTIME_END

}  // namespace ringdown::synth
#endif
