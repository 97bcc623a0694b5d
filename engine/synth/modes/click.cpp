#include "engine/synth/modes/click.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::synth {
namespace {

using Complex = std::complex<double>;

constexpr double kMinClick_frames = 4;  // of a pulse: what is shorter would fold back from beyond Nyquist
constexpr double kDecays = 16;          // decay times, after which it is 139 dB down

Complex polar(double log_size, double angle) REALTIME {
  const double size = std::exp(log_size);
  return {size * std::cos(angle), size * std::sin(angle)};
}

}  // namespace

double radius_of(const modal::MassProperties& mass) {
  const Vec3& inertia = mass.inertia_kg_m2;
  return std::sqrt(2.5 * (inertia.x + inertia.y + inertia.z) / 3 / mass.mass_kg);
}

// With a = c/R the filter is H(s) = 2as / ((s + a)^2 + a^2). To a force sin(wt) from t = 0 it answers with
// Im(H(iw) exp(iwt)) + Re(B exp((-a + ia) t)), where B lets answer and derivative be 0 at t = 0. A half-sine is that
// force and the same again half a period later.
Click::Click(const ClickShape& shape, double impulse_ns, double contact_time_s, double sample_rate_hz) REALTIME {
  const double frames = std::max(contact_time_s * sample_rate_hz, kMinClick_frames);
  const double a = shape.corner_per_s / sample_rate_hz, w = std::numbers::pi / frames;
  const double peak = shape.gain * impulse_ns * 0.5 * w * sample_rate_hz;
  const double re = 2 * a * a - w * w, im = 2 * a * w;  // H's denominator at iw; its numerator is i im
  const double size = peak * im / (re * re + im * im);
  push_ = {size * im, size * re};
  push_pole_ = polar(0, w);
  // Re B = -Im H and Re((-a + ia) B) = -Re(w H), with H for push_
  const double b = -push_.imag();
  ring_ = {b, (w * push_.real() - a * b) / a};
  ring_pole_ = polar(-a, a);
  release_ = static_cast<std::int64_t>(std::ceil(frames));
  const double since = static_cast<double>(release_) - frames;
  released_ = polar(-a * since, a * since);
  released_ = {released_.real() * ring_.real() - released_.imag() * ring_.imag(),
               released_.real() * ring_.imag() + released_.imag() * ring_.real()};
  end_ = release_ + static_cast<std::int64_t>(kDecays / a);
}

void Click::fill(std::size_t count, double* out) REALTIME {
  const auto turn = [](Complex& z, const Complex& by) REALTIME {
    z = {z.real() * by.real() - z.imag() * by.imag(), z.real() * by.imag() + z.imag() * by.real()};
  };
  for (std::size_t i = 0; i < count; ++i, ++at_) {
    if (at_ == release_) {
      push_ = 0;
      ring_ = {ring_.real() + released_.real(), ring_.imag() + released_.imag()};
    }
    out[i] = at_ < end_ ? push_.imag() + ring_.real() : 0.0;
    turn(push_, push_pole_);
    turn(ring_, ring_pole_);
  }
}

}  // namespace ringdown::synth
