#include <hwy/highway.h>

#include "engine/synth/kernels/mix_kernel.h"

#include <algorithm>
#include <cmath>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void add_scaled_here(const double* from, double gain, double* out, std::size_t frames) {
  const hn::CappedTag<double, 8> tag;
  const std::size_t lanes = hn::Lanes(tag);
  const auto factor = hn::Set(tag, gain);
  std::size_t n = 0;
  for (; n + lanes <= frames; n += lanes) {
    hn::StoreU(hn::MulAdd(factor, hn::LoadU(tag, from + n), hn::LoadU(tag, out + n)), tag, out + n);
  }
  for (; n < frames; ++n) out[n] += gain * from[n];
}

void write_scaled_here(const double* from, double gain, double* out, std::size_t frames) {
  const hn::CappedTag<double, 8> tag;
  const std::size_t lanes = hn::Lanes(tag);
  const auto factor = hn::Set(tag, gain);
  std::size_t n = 0;
  for (; n + lanes <= frames; n += lanes) hn::StoreU(hn::Mul(factor, hn::LoadU(tag, from + n)), tag, out + n);
  for (; n < frames; ++n) out[n] = gain * from[n];
}

// A sample that is not a number compares as false, so it is not within the limit.
bool all_within_here(const double* samples, double max, std::size_t count) {
  const hn::CappedTag<double, 8> tag;
  const std::size_t lanes = hn::Lanes(tag);
  const auto limit = hn::Set(tag, max);
  auto within = hn::Eq(limit, limit);
  std::size_t n = 0;
  for (; n + lanes <= count; n += lanes) {
    within = hn::And(within, hn::Le(hn::Abs(hn::LoadU(tag, samples + n)), limit));
  }
  bool rest = true;
  for (; n < count; ++n) rest = rest && std::abs(samples[n]) <= max;
  return rest && hn::AllTrue(tag, within);
}

// Four vectors of results of each filter stay in registers, and each vector of samples is read for both.
void add_filtered_here(const float* samples, std::size_t taps, const FilterOutput& first, const FilterOutput& second,
                       std::size_t frames) {
  const hn::CappedTag<float, kFilterOverrun / 4> tag;
  using Vector = hn::Vec<decltype(tag)>;
  const std::size_t lanes = hn::Lanes(tag);
  for (std::size_t n = 0; n < frames; n += 4 * lanes) {
    float *const to = first.out + n, *const other = second.out + n;
    Vector a0 = hn::LoadU(tag, to), a1 = hn::LoadU(tag, to + lanes), a2 = hn::LoadU(tag, to + 2 * lanes),
           a3 = hn::LoadU(tag, to + 3 * lanes);
    Vector b0 = hn::LoadU(tag, other), b1 = hn::LoadU(tag, other + lanes), b2 = hn::LoadU(tag, other + 2 * lanes),
           b3 = hn::LoadU(tag, other + 3 * lanes);
    for (std::size_t j = 0; j < taps; ++j) {
      const Vector a = hn::Set(tag, first.reversed[j]), b = hn::Set(tag, second.reversed[j]);
      const float* const from = samples + n + j;
      const Vector s0 = hn::LoadU(tag, from), s1 = hn::LoadU(tag, from + lanes);
      const Vector s2 = hn::LoadU(tag, from + 2 * lanes), s3 = hn::LoadU(tag, from + 3 * lanes);
      a0 = hn::MulAdd(a, s0, a0);
      a1 = hn::MulAdd(a, s1, a1);
      a2 = hn::MulAdd(a, s2, a2);
      a3 = hn::MulAdd(a, s3, a3);
      b0 = hn::MulAdd(b, s0, b0);
      b1 = hn::MulAdd(b, s1, b1);
      b2 = hn::MulAdd(b, s2, b2);
      b3 = hn::MulAdd(b, s3, b3);
    }
    hn::StoreU(a0, tag, to), hn::StoreU(a1, tag, to + lanes), hn::StoreU(a2, tag, to + 2 * lanes);
    hn::StoreU(a3, tag, to + 3 * lanes), hn::StoreU(b0, tag, other), hn::StoreU(b1, tag, other + lanes);
    hn::StoreU(b2, tag, other + 2 * lanes), hn::StoreU(b3, tag, other + 3 * lanes);
  }
}

float write_samples_here(const double* from, float* to, std::size_t frames) {
  const hn::CappedTag<double, 8> wide;
  const hn::CappedTag<float, hn::MaxLanes(hn::CappedTag<double, 8>())> narrow;
  const std::size_t lanes = hn::Lanes(wide);
  const auto largest = hn::Set(narrow, std::numeric_limits<float>::max());
  auto peak = hn::Zero(narrow);
  auto finite = hn::Eq(peak, peak);
  std::size_t n = 0;
  for (; n + lanes <= frames; n += lanes) {
    const auto sample = hn::DemoteTo(narrow, hn::LoadU(wide, from + n));
    hn::StoreU(sample, narrow, to + n);
    const auto size = hn::Abs(sample);
    peak = hn::Max(size, peak);
    finite = hn::And(finite, hn::Le(size, largest));
  }
  float highest = hn::GetLane(hn::MaxOfLanes(narrow, peak));
  bool sound = hn::AllTrue(narrow, finite);
  for (; n < frames; ++n) {
    to[n] = static_cast<float>(from[n]);
    highest = std::max(highest, std::abs(to[n]));
    sound = sound && std::isfinite(to[n]);
  }
  if (sound) return highest;
  std::fill_n(to, frames, 0.0F);
  return std::numeric_limits<float>::infinity();
}

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ringdown::synth {

HWY_EXPORT(add_scaled_here);
HWY_EXPORT(write_scaled_here);
HWY_EXPORT(all_within_here);
HWY_EXPORT(add_filtered_here);
HWY_EXPORT(write_samples_here);

// Highway's dispatch reads an atomic, and indexes a table of functions, all of them in this file.
TRUST_REALTIME_BEGIN
void add_scaled(const double* from, double gain, double* out, std::size_t frames) REALTIME {
  HWY_DYNAMIC_DISPATCH(add_scaled_here)(from, gain, out, frames);
}

void write_scaled(const double* from, double gain, double* out, std::size_t frames) REALTIME {
  HWY_DYNAMIC_DISPATCH(write_scaled_here)(from, gain, out, frames);
}

bool all_within(const double* samples, double max, std::size_t count) REALTIME {
  return HWY_DYNAMIC_DISPATCH(all_within_here)(samples, max, count);
}

void add_filtered(const float* samples, std::size_t taps, const FilterOutput& first, const FilterOutput& second,
                  std::size_t frames) REALTIME {
  HWY_DYNAMIC_DISPATCH(add_filtered_here)(samples, taps, first, second, frames);
}

float write_samples(const double* from, float* to, std::size_t frames) REALTIME {
  return HWY_DYNAMIC_DISPATCH(write_samples_here)(from, to, frames);
}
TRUST_REALTIME_END

}  // namespace ringdown::synth
#endif
