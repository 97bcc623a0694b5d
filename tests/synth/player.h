// A mixer and a tape: what the synth tests play with. Nothing here computes sound except closed_form().
#pragma once

#include "engine/synth/mixer.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace ringdown::synth::test {

using namespace ringdown::test;  // NOLINT: the measuring instruments

inline constexpr double kRate = 48000;

using Map = std::shared_ptr<const modal::StrikeMap>;

inline Map map_of(modal::Bank bank) { return std::make_shared<const modal::StrikeMap>(shared(std::move(bank))); }

inline std::unique_ptr<Voice> voice_of(Map map, double rate = kRate, const modal::MaterialScale& material = {}) {
  return std::make_unique<Voice>(std::move(map), material, rate);
}

inline Event strike_at(Frame frame, ObjectNumber object, Vec3 impulse_ns, double contact_time_s = 0,
                       Vec3 point_m = {1, 1, 1}) {
  return {.frame = frame,
          .object = object,
          .verb = verb::Strike{.point_m = point_m, .impulse_ns = impulse_ns, .contact_time_s = contact_time_s}};
}
inline Event vertex_strike_at(Frame frame, ObjectNumber object, std::uint32_t vertex, Vec3 impulse_ns,
                              double contact_time_s = 0) {
  return {frame, object, verb::StrikeVertex{vertex, impulse_ns, contact_time_s}};
}
inline Event gain_at(Frame frame, ObjectNumber object, double gain, double ramp_s = 0) {
  return {frame, object, verb::Gain{gain, ramp_s}};
}
inline Event pan_at(Frame frame, ObjectNumber object, double pan) { return {frame, object, verb::Pan{pan}}; }
inline Event clear_at(Frame frame, ObjectNumber object, double ramp_s = 0) {
  return {frame, object, verb::Clear{ramp_s}};
}
// The event that makes this two-way contact. A mallet is a collision, which may have another object's surface as head.
inline Event touch_at(Frame frame, ObjectNumber object, Vec3 point_m, const Touch& how) {
  Verb verb = verb::Strike{};
  switch (how.kind) {
    case Touch::Kind::bow:
      verb = verb::Bow{point_m, how.direction, how.speed_m_s, how.force_n, how.width_m, how.friction, how.number};
      break;
    case Touch::Kind::mallet:
      verb = verb::Collision{point_m,    how.direction, how.speed_m_s,     how.mass_kg,        how.stiffness,
                             how.bounce, how.other,     how.other_point_m, how.other_direction};
      break;
    case Touch::Kind::couple:
      verb = verb::Couple{point_m,       how.other,    how.other_point_m, how.direction, how.force_n, how.gap_m,
                          how.stiffness, how.friction, how.bounce,        how.mass_kg,   how.number};
      break;
    case Touch::Kind::rub:
      verb = verb::Rub{point_m,      how.contact, how.direction, how.slide_m_s, how.force_n,       how.mass_kg,
                       how.friction, how.sliding, how.stiffness, how.other,     how.other_point_m, how.to_other};
      break;
  }
  return {frame, object, verb};
}

// Changes one of the mixer's settings.
template <class T>
void set(Mixer& mixer, T MixerSettings::*setting, std::type_identity_t<T> value) {
  MixerSettings settings = mixer.settings();
  settings.*setting = value;
  mixer.configure(settings);
}

// Records what the mixer plays. Objects are installed and events pushed between renders, by the one test thread.
class Player {
 public:
  explicit Player(double rate = kRate) : mixer(rate) {}

  void install(ObjectNumber object, const Map& map, Mixer::Install how = Mixer::Install::replace,
               const modal::MaterialScale& material = {}) {
    ASSERT_TRUE(mixer.install(object, voice_of(map, mixer.sample_rate_hz(), material), how));
  }
  void push(const Event& event) { ASSERT_TRUE(mixer.push(Producer::control, event)); }

  void render(std::size_t frames, std::size_t block = 256) {
    std::vector<float> l(block), r(block);
    for (std::size_t done = 0; done < frames;) {
      const std::size_t now = std::min(block, frames - done);
      mixer.render(std::span(l).first(now), std::span(r).first(now));
      left.insert(left.end(), l.begin(), l.begin() + static_cast<std::ptrdiff_t>(now));
      right.insert(right.end(), r.begin(), r.begin() + static_cast<std::ptrdiff_t>(now));
      done += now;
    }
  }

  [[nodiscard]] std::span<const double> left_from(std::size_t frame) const { return std::span(left).subspan(frame); }

  Mixer mixer;
  Samples left, right;
};

// The half-sine pulse's spectrum as it stands in docs/how/physics.md, without care for the removable pole.
inline long double pulse_factor(long double f, long double tau) {
  const long double x = 2 * f * tau;
  return std::cos(std::numbers::pi_v<long double> * f * tau) / (1 - x * x);
}

// One channel of one struck mode, the channel's gain 1 / sqrt 2 in the centre:
// scale 2 pi f (phi . j) F(f) exp(-d t) sin(2 pi f t), t from the strike.
inline Samples closed_form(double f, double d, double phi_dot_j, double contact_time_s, double rate, std::size_t count,
                           double channel_gain = std::numbers::sqrt2 / 2) {
  const long double omega = 2 * std::numbers::pi_v<long double> * static_cast<long double>(f);
  const long double scale =
      channel_gain * ringdown::test::kLoudness * omega * phi_dot_j * pulse_factor(f, contact_time_s);
  Samples samples(count);
  for (std::size_t n = 0; n < count; ++n) {
    const long double t = static_cast<long double>(n) / static_cast<long double>(rate);
    samples[n] = static_cast<double>(scale * std::exp(-d * t) * std::sin(omega * t));
  }
  return samples;
}

}  // namespace ringdown::synth::test
