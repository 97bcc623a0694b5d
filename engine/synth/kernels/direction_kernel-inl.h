#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>

#include "engine/synth/kernels/direction_kernel.h"

#include "engine/synth/kernels/mode_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

// A group's sums stay in registers for all of its terms.
void look_up_here(const modal::DirectionMap& map, const float* harmonics, float* re, float* im) {
  constexpr std::size_t kGroup = modal::DirectionMap::kGroup;
  const hn::CappedTag<float, kGroup> tag;
  constexpr std::size_t kLanes = hn::MaxLanes(hn::CappedTag<float, kGroup>()), kVectors = 2 * kGroup / kLanes;
  const std::uint32_t* const first = map.first();
  for (std::size_t group = 0; group < map.groups(); ++group, re += kGroup, im += kGroup) {
    hn::Vec<decltype(tag)> sum[kVectors], other[kVectors];  // two sums, so that additions do not wait for each other
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) sum[v] = other[v] = hn::Zero(tag);
    std::uint32_t term = first[group];
    const std::uint32_t end = first[group + 1];
    const float* values = map.values() + std::size_t{term} * 2 * kGroup;
    for (; term + 2 <= end; term += 2, values += 4 * kGroup) {
      const auto a = hn::Set(tag, harmonics[map.harmonics()[term]]);
      const auto b = hn::Set(tag, harmonics[map.harmonics()[term + 1]]);
      RINGDOWN_UNROLL
      for (std::size_t v = 0; v < kVectors; ++v) {
        sum[v] = hn::MulAdd(a, hn::LoadU(tag, values + v * kLanes), sum[v]);
        other[v] = hn::MulAdd(b, hn::LoadU(tag, values + 2 * kGroup + v * kLanes), other[v]);
      }
    }
    if (term < end) {
      const auto a = hn::Set(tag, harmonics[map.harmonics()[term]]);
      RINGDOWN_UNROLL
      for (std::size_t v = 0; v < kVectors; ++v) sum[v] = hn::MulAdd(a, hn::LoadU(tag, values + v * kLanes), sum[v]);
    }
    RINGDOWN_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) {
      float* const to = v < kVectors / 2 ? re + v * kLanes : im + (v - kVectors / 2) * kLanes;
      hn::StoreU(hn::Add(sum[v], other[v]), tag, to);
    }
  }
}

void find_absorption_here(const modal::AirAbsorption& air, double distance_m, const float* frequency_hz,
                          std::size_t count, float* out) {
  const hn::CappedTag<float, 8> tag;
  const auto set = [&](double x) HWY_ATTR { return hn::Set(tag, static_cast<float>(x)); };
  // In units of kHz and of 1e-6 f^2, so that floats suffice.
  const auto oxygen_hz = set(1e-3 * air.oxygen_relaxation_hz), per_oxygen_hz = set(1e3 / air.oxygen_relaxation_hz);
  const auto nitrogen_hz = set(1e-3 * air.nitrogen_relaxation_hz),
             per_nitrogen_hz = set(1e3 / air.nitrogen_relaxation_hz);
  const auto classical = set(-1e6 * distance_m * air.classical), oxygen = set(-1e3 * distance_m * air.oxygen),
             nitrogen = set(-1e3 * distance_m * air.nitrogen);
  for (std::size_t i = 0; i < count; i += hn::Lanes(tag)) {
    const auto khz = hn::Mul(hn::Load(tag, frequency_hz + i), set(1e-3)), f2 = hn::Mul(khz, khz);
    const auto by_oxygen = hn::Div(oxygen, hn::MulAdd(f2, per_oxygen_hz, oxygen_hz));
    const auto by_nitrogen = hn::Div(nitrogen, hn::MulAdd(f2, per_nitrogen_hz, nitrogen_hz));
    const auto exponent = hn::Mul(f2, hn::Add(classical, hn::Add(by_oxygen, by_nitrogen)));
    hn::Store(hn::Exp(tag, hn::Max(exponent, set(-80))), tag, out + i);
  }
}

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ringdown::synth {

HWY_EXPORT(look_up_here);
HWY_EXPORT(find_absorption_here);

// Highway's dispatch reads an atomic, and indexes a table of functions, all of them in this file.
TRUST_REALTIME_BEGIN
void look_up(const modal::DirectionMap& map, const float* harmonics, float* re, float* im) REALTIME {
  HWY_DYNAMIC_DISPATCH(look_up_here)(map, harmonics, re, im);
}
void find_absorption(const modal::AirAbsorption& air, double distance_m, const float* frequency_hz, std::size_t count,
                     float* out) REALTIME {
  HWY_DYNAMIC_DISPATCH(find_absorption_here)(air, distance_m, frequency_hz, count, out);
}
TRUST_REALTIME_END

}  // namespace ringdown::synth
#endif
