#include "engine/synth/rubbing.h"

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
double random_at(std::uint64_t seed, std::int64_t place) RINGDOWN_REALTIME {
  std::uint64_t x = seed * 0xd1342543de82ef95u ^ static_cast<std::uint64_t>(place) * 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  x ^= x >> 31;
  return static_cast<double>(static_cast<std::int64_t>(x)) * 0x1p-63;
}

}  // namespace

Rubbing::Rubbing(std::uint32_t seed, double sample_rate_hz) RINGDOWN_REALTIME : rate_hz_(sample_rate_hz) {
  for (std::size_t i = 0; i < kOctaves; ++i) {
    sliding_.octaves[i].seed = 2 * kOctaves * std::uint64_t{seed} + i;
    rolling_.octaves[i].seed = sliding_.octaves[i].seed + kOctaves;
  }
}

void Rubbing::update(Frame at, const Contact& contact) RINGDOWN_REALTIME {
  const double force = length(contact.force_n);
  if (force == 0 && force_n_.to == 0) return;  // it is ending already
  const bool changes = force > 0 && heights_m_[0] > 0;
  const double since_s = changes ? static_cast<double>(at - updated_) / rate_hz_ : kFade_s;
  const auto ramp = static_cast<Frame>(std::clamp(since_s, kMinForceRamp_s, kMaxForceRamp_s) * rate_hz_);
  updated_ = at;
  force_n_.aim(force, at, ramp);
  time_out_ = at + static_cast<Frame>(kContactTimeOut_s * rate_hz_);
  if (force == 0) return;  // it ends as it moves
  slip_m_s_.aim(contact.slip_m_s, at, ramp);
  roll_m_s_.aim(contact.roll_m_s, at, ramp);
  if (heights_m_[0] > 0 && contact.texture == texture_) return;
  texture_ = contact.texture;
  sliding_.longest_m = texture_.correlation_m;
  rolling_.longest_m = kRollingRatio * texture_.correlation_m;
  double power = 0;
  for (std::size_t octave = 0; octave < kOctaves; ++octave) {
    const double share = std::exp2(static_cast<double>(octave) * (texture_.spectral_slope + 1));
    heights_m_[octave] = std::sqrt(share);
    power += share * kSplineVariance;
  }
  for (double& height : heights_m_) height *= texture_.roughness_m / std::sqrt(power);
}

// The derivative of the spline.
double Rubbing::Spline::slope_at(double u) RINGDOWN_REALTIME {
  const double floor = std::floor(u), t = u - floor, rest = 1 - t;
  const auto wanted = static_cast<std::int64_t>(floor);
  if (!fresh && wanted == place + 1) {
    around = {around[1], around[2], around[3], random_at(seed, wanted + 2)};
  } else if (fresh || wanted != place) {
    for (std::size_t i = 0; i < around.size(); ++i)
      around[i] = random_at(seed, wanted - 1 + static_cast<std::int64_t>(i));
  }
  place = wanted, fresh = false;
  return -0.5 * rest * rest * around[0] + (1.5 * t - 2) * t * around[1] + ((-1.5 * t + 1) * t + 0.5) * around[2] +
         0.5 * t * t * around[3];
}

double Rubbing::Track::pass(const Heights& heights_m, double speed_m_s, double sample_rate_hz) RINGDOWN_REALTIME {
  double slope = 0, spacing_m = 0.5 * longest_m;
  for (std::size_t i = 0; i < kOctaves; ++i, spacing_m *= 0.5) {
    const double passing = speed_m_s / (2 * spacing_m * sample_rate_hz);  // waves in a frame
    if (passing >= kNoOctave) break;
    const double part = std::min(1.0, (kNoOctave - passing) / (kNoOctave - kFullOctave));
    slope += part * heights_m[i] / spacing_m * octaves[i].slope_at(at_m / spacing_m);
  }
  at_m += speed_m_s / sample_rate_hz;
  return slope;
}

// The impulse of a frame is the force's magnitude, times the slope of the two profiles under the contact, times the
// length of the frame. Force and speeds follow the last update by ramps (Ramp), and each profile moves on by its speed
// (Track::pass). The running mean of the slope, with a time constant of 1 / (2 pi kMinAudible_hz), is subtracted,
// because a constant part would push the modes aside without being heard.
void Rubbing::fill(Frame first, std::size_t count, double* impulses) RINGDOWN_REALTIME {
  const double seconds = 1 / rate_hz_, forget = 1 - std::exp(-2 * std::numbers::pi * kMinAudible_hz * seconds);
  for (std::size_t i = 0; i < count; ++i) {
    const Frame frame = first + static_cast<Frame>(i);
    if (frame >= time_out_ && force_n_.to != 0) force_n_.aim(0, frame, static_cast<Frame>(kFade_s * rate_hz_));
    const double slope = sliding_.pass(heights_m_, slip_m_s_.at(frame), rate_hz_) +
                         rolling_.pass(heights_m_, roll_m_s_.at(frame), rate_hz_);
    mean_slope_ += (begun_ ? forget : 1) * (slope - mean_slope_);
    begun_ = begun_ || heights_m_[0] > 0;  // it may be asked before its first update
    impulses[i] = force_n_.at(frame) * (slope - mean_slope_) * seconds;
  }
}

void Rubbing::rescale(Frame now, double ratio) {
  const auto moved = [now, ratio](Frame frame) {
    return now + static_cast<Frame>(std::llround(static_cast<double>(frame - now) * ratio));
  };
  for (Ramp* ramp : {&force_n_, &slip_m_s_, &roll_m_s_}) ramp->begin = moved(ramp->begin), ramp->end = moved(ramp->end);
  updated_ = moved(updated_), time_out_ = moved(time_out_);
  rate_hz_ *= ratio;
}

}  // namespace ringdown::synth
