#include <hwy/highway.h>

#include "engine/synth/kernels/pulse_kernel.h"

#include "engine/synth/kernels/mode_vectors-inl.h"

#include <numbers>

// The spectrum of the pulse is F(x) = cos(pi/2 x) / (1 - x^2) with x = 2 f tau. The cosine repeats after x = 4, so with
// x reduced to -2 ... 2 and v = 1 - |x| it is sin(pi/2 v) = pi/2 v P(v^2). P is the Taylor series of the sine up to
// v^19, whose remainder is below 2e-16. Where the pole of F at x = 1 has to be removed, up to x = 2, v is exactly 1 - x
// and cancels: F = pi/2 P / (1 + x).
HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

struct SineSeries {
  static constexpr int kTerms = 10;
  double factor[kTerms] = {1};  // of v^(2 k)
  constexpr SineSeries() {
    constexpr double kSquare = std::numbers::pi * std::numbers::pi / 4;
    for (int k = 1; k < kTerms; ++k) factor[k] = -factor[k - 1] * kSquare / (2 * k * (2 * k + 1));
  }
};

// Returns sin(pi/2 v) / (pi/2 v) for v^2 <= 1.
HWY_INLINE Vec sine_ratio(Vec v_squared) {
  constexpr SineSeries kSeries;
  const Tag tag;
  Vec sum = hn::Set(tag, kSeries.factor[SineSeries::kTerms - 1]);
  for (int k = SineSeries::kTerms - 2; k >= 0; --k) {
    sum = hn::MulAdd(sum, v_squared, hn::Set(tag, kSeries.factor[k]));
  }
  return sum;
}

double shape_by_pulse_here(const double* HWY_RESTRICT omega, std::size_t count, double contact_frames,
                           double* HWY_RESTRICT amplitudes) {
  const Tag tag;
  const Vec one = hn::Set(tag, 1.0), x_per_omega = hn::Set(tag, contact_frames / std::numbers::pi);
  Vec energy = hn::Zero(tag);
  for (std::size_t i = 0; i < count; i += hn::Lanes(tag)) {
    const Vec x = hn::Mul(hn::Load(tag, omega + i), x_per_omega);
    const Vec turns = hn::Round(hn::Mul(x, hn::Set(tag, 0.25)));
    const Vec v = hn::Sub(one, hn::Abs(hn::NegMulAdd(turns, hn::Set(tag, 4.0), x)));
    const Vec above = hn::Add(one, x);
    const auto near = hn::Le(x, hn::Set(tag, 2.0));
    const Vec numerator = hn::IfThenElse(near, one, v);
    const Vec denominator = hn::IfThenElse(near, above, hn::Mul(above, hn::Sub(one, x)));
    const Vec spectrum = hn::Div(hn::Mul(sine_ratio(hn::Mul(v, v)), numerator), denominator);
    const Vec amplitude = hn::Mul(hn::Load(tag, amplitudes + i), hn::Mul(spectrum, hn::Set(tag, std::numbers::pi / 2)));
    hn::Store(amplitude, tag, amplitudes + i);
    energy = hn::MulAdd(amplitude, amplitude, energy);
  }
  return hn::GetLane(hn::SumOfLanes(tag, energy));
}

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ringdown::synth {

HWY_EXPORT(shape_by_pulse_here);

// Highway's dispatch reads an atomic, and indexes a table of functions, all of them in this file.
TRUST_REALTIME_BEGIN
double shape_by_pulse(const double* omega, std::size_t count, double contact_frames, double* amplitudes) REALTIME {
  return HWY_DYNAMIC_DISPATCH(shape_by_pulse_here)(omega, count, contact_frames, amplitudes);
}
TRUST_REALTIME_END

}  // namespace ringdown::synth
#endif
