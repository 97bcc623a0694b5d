#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/synth/mix_kernel.cpp"
#include <hwy/foreach_target.h>  // compiles the rest of this file once per instruction set

#include <hwy/highway.h>

#include "engine/synth/mix_kernel.h"

#include <algorithm>
#include <cmath>

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

float write_samples_here(const double* from, float* to, std::size_t frames) {
  const hn::CappedTag<double, 8> wide;
  const hn::CappedTag<float, hn::MaxLanes(hn::CappedTag<double, 8>())> narrow;
  const std::size_t lanes = hn::Lanes(wide);
  auto peak = hn::Zero(narrow);
  std::size_t n = 0;
  for (; n + lanes <= frames; n += lanes) {
    const auto sample = hn::DemoteTo(narrow, hn::LoadU(wide, from + n));
    hn::StoreU(sample, narrow, to + n);
    peak = hn::Max(hn::Abs(sample), peak);
  }
  float highest = hn::GetLane(hn::MaxOfLanes(narrow, peak));
  for (; n < frames; ++n) {
    to[n] = static_cast<float>(from[n]);
    highest = std::max(highest, std::abs(to[n]));
  }
  return highest;
}

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ringdown::synth {

HWY_EXPORT(add_scaled_here);
HWY_EXPORT(write_samples_here);

// Highway's dispatch reads an atomic, and indexes a table of functions, all of them in this file.
RINGDOWN_TRUST_REALTIME_BEGIN
void add_scaled(const double* from, double gain, double* out, std::size_t frames) RINGDOWN_REALTIME {
  HWY_DYNAMIC_DISPATCH(add_scaled_here)(from, gain, out, frames);
}

float write_samples(const double* from, float* to, std::size_t frames) RINGDOWN_REALTIME {
  return HWY_DYNAMIC_DISPATCH(write_samples_here)(from, to, frames);
}
RINGDOWN_TRUST_REALTIME_END

}  // namespace ringdown::synth
#endif
