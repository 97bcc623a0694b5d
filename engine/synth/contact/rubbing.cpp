#include "engine/synth/contact/rubbing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::synth {
namespace {

constexpr double kMinForceRamp_s = 0.002, kMaxForceRamp_s = 0.05;
constexpr double kFade_s = 0.005;                       // of a contact that begins or ends
constexpr double kMinAudible_hz = 20;                   // slower changes of the force are not heard
constexpr double kFullOctave = 0.25, kNoOctave = 0.45;  // of the sample rate: an octave fades out between them
// The variance of a cubic B-spline over random numbers in [-1, 1): theirs, 1/3, times the mean of the sum of B(u -
// i)^2.
constexpr double kSplineVariance = 151.0 / 945;

// A number in [-1, 1) for each place. The mixing steps are those of SplitMix64 (Steele, Lea & Flood, OOPSLA 2014).
double random_at(std::uint64_t seed, std::int64_t place) REALTIME {
  std::uint64_t x = seed * 0xd1342543de82ef95u ^ static_cast<std::uint64_t>(place) * 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  x ^= x >> 31;
  return static_cast<double>(static_cast<std::int64_t>(x)) * 0x1p-63;
}

}  // namespace

Rubbing::Rubbing(std::uint32_t seed, double sample_rate_hz) REALTIME : rate_hz_(sample_rate_hz) {
  for (std::size_t i = 0; i < kMaxOctaves; ++i) {
    sliding_.octaves[i].seed = (2 * kOctaves * std::uint64_t{seed} + i % kOctaves) ^ std::uint64_t{i / kOctaves} << 48;
    rolling_.octaves[i].seed = sliding_.octaves[i].seed + kOctaves;
  }
}

void Rubbing::update(Frame at, const Contact& contact) REALTIME {
  const double force = length(contact.force_n);
  if (force == 0 && force_n_.to == 0) return;  // it is ending already
  const bool changes = force > 0 && heights_m_.count > 0;
  const double since_s = changes ? static_cast<double>(at - updated_) / rate_hz_ : kFade_s;
  const auto ramp = static_cast<Frame>(std::clamp(since_s, kMinForceRamp_s, kMaxForceRamp_s) * rate_hz_);
  updated_ = at;
  force_n_.aim(force, at, ramp);
  time_out_ = contact.stays ? kNever : at + static_cast<Frame>(kContactTimeOut_s * rate_hz_);
  if (force == 0) return;  // it ends as it moves
  slip_m_s_.aim(contact.slip_m_s, at, ramp);
  roll_m_s_.aim(contact.roll_m_s, at, ramp);
  know(contact, at, ramp);
  if (heights_m_.count > 0 && contact.texture == texture_) return;
  texture_ = contact.texture;
  sliding_.longest_m = texture_.correlation_m;
  rolling_.longest_m = kRollingRatio * texture_.correlation_m;
  heights_m_.count = texture_.octaves();
  double power = 0;
  for (std::size_t octave = 0; octave < heights_m_.count; ++octave) {
    const double share = std::exp2(static_cast<double>(octave) * (texture_.spectral_slope + 1));
    heights_m_.of_octave_m[octave] = std::sqrt(share);
    power += share * kSplineVariance;
  }
  for (double& height : heights_m_.of_octave_m) height *= texture_.roughness_m / std::sqrt(power);
}

// The levels of the tracks follow the speed at the time of the event, so that they do not depend on where blocks end.
void Rubbing::know(const Contact& contact, Frame at, Frame ramp) REALTIME {
  has_profile_ = has_relief_ = false;
  for (std::size_t k = 0; k < known_.size(); ++k) {
    Known& known = known_[k];
    const Passing& passing = contact.surfaces[k];
    if (passing.relief != known.relief) known = {.relief = passing.relief};
    if (!known.relief) continue;
    known.speed_m_s.aim(passing.speed_m_s, at, ramp);
    const double step_m = std::max(known.speed_m_s.from, known.speed_m_s.to) / rate_hz_;
    if (const auto& profile = known.relief->profile) {
      has_profile_ = true;
      known.profile = profile->blend(contact.finish_width_m, step_m);
    }
    if (const auto& mesoscale = known.relief->mesoscale) {
      has_relief_ = true;
      known.mesoscale = mesoscale->blend(contact.relief_width_m, step_m);
    }
  }
}

// The slopes of the surfaces whose heights are known; the contact moves on over them for a frame.
double Rubbing::pass_known(Frame frame) REALTIME {
  double slope = 0;
  for (Known& known : known_) {
    if (!known.relief) continue;
    if (const auto& profile = known.relief->profile) slope += profile->slope_at(known.at_m, known.profile);
    if (const auto& mesoscale = known.relief->mesoscale) slope += mesoscale->slope_at(known.at_m, known.mesoscale);
    known.at_m += known.speed_m_s.at(frame) / rate_hz_;
  }
  return slope;
}

// The derivative of the spline.
double Rubbing::Spline::slope_at(double u) REALTIME {
  const double floor = std::floor(u), t = u - floor, rest = 1 - t;
  const auto wanted = static_cast<std::int64_t>(floor);
  if (!fresh && wanted == place + 1) {
    around = {around[1], around[2], around[3], random_at(seed, wanted + 2)};
  } else if (fresh || wanted != place) {
    for (std::size_t i = 0; i < around.size(); ++i)
      around[i] = random_at(seed, wanted - 1 + static_cast<std::int64_t>(i));
  }
  place = wanted;
  fresh = false;
  return -0.5 * rest * rest * around[0] + (1.5 * t - 2) * t * around[1] + ((-1.5 * t + 1) * t + 0.5) * around[2] +
         0.5 * t * t * around[3];
}

double Rubbing::Track::pass(const Heights& heights_m, double speed_m_s, double sample_rate_hz) REALTIME {
  double slope = 0, spacing_m = 0.5 * longest_m;
  for (std::size_t i = 0; i < heights_m.count; ++i, spacing_m *= 0.5) {
    const double passing = speed_m_s / (2 * spacing_m * sample_rate_hz);  // waves in a frame
    if (passing >= kNoOctave) break;
    const double part = std::min(1.0, (kNoOctave - passing) / (kNoOctave - kFullOctave));
    slope += part * heights_m.of_octave_m[i] / spacing_m * octaves[i].slope_at(at_m / spacing_m);
  }
  at_m += speed_m_s / sample_rate_hz;
  return slope;
}

// The impulse of a frame is the force's magnitude, times the slope of the profiles under the contact, times the
// length of the frame. Force and speeds follow the last update by ramps (Ramp).
void Rubbing::fill(Frame first, std::size_t count, double* impulses) REALTIME {
  const double seconds = 1 / rate_hz_;
  fill_slopes(first, count, impulses);
  for (std::size_t i = 0; i < count; ++i) {
    const Frame frame = first + static_cast<Frame>(i);
    if (frame >= time_out_ && force_n_.to != 0) force_n_.aim(0, frame, static_cast<Frame>(kFade_s * rate_hz_));
    impulses[i] = force_n_.at(frame) * impulses[i] * seconds;
  }
}

// Each profile moves on by its speed (Track::pass). The running mean of the slope, with a time constant of
// 1 / (2 pi kMinAudible_hz), is subtracted, because a constant part would push the modes aside without being heard.
void Rubbing::fill_slopes(Frame first, std::size_t count, double* slopes) REALTIME {
  const double forget = 1 - std::exp(-2 * std::numbers::pi * kMinAudible_hz / rate_hz_);
  for (std::size_t i = 0; i < count; ++i) {
    const Frame frame = first + static_cast<Frame>(i);
    double slope = 0;
    if (!has_profile_) {
      slope = sliding_.pass(heights_m_, slip_m_s_.at(frame), rate_hz_) +
              rolling_.pass(heights_m_, roll_m_s_.at(frame), rate_hz_);
    }
    if (has_profile_ || has_relief_) slope += pass_known(frame);
    mean_slope_ += (begun_ ? forget : 1) * (slope - mean_slope_);
    begun_ = begun_ || heights_m_.count > 0;  // it may be asked before its first update
    slopes[i] = slope - mean_slope_;
  }
}

void Rubbing::rescale(Frame now, double ratio) {
  const auto moved = [now, ratio](Frame frame) {
    return now + static_cast<Frame>(std::llround(static_cast<double>(frame - now) * ratio));
  };
  for (Ramp* ramp : {&force_n_, &slip_m_s_, &roll_m_s_, &known_[0].speed_m_s, &known_[1].speed_m_s}) {
    ramp->begin = moved(ramp->begin);
    ramp->end = moved(ramp->end);
  }
  updated_ = moved(updated_);
  if (time_out_ != kNever) time_out_ = moved(time_out_);
  rate_hz_ *= ratio;
}

}  // namespace ringdown::synth
