#include "engine/synth/listening/listening.h"

#include <algorithm>
#include <cmath>

namespace ringdown::synth {

// Without travel time, the rate is that of the sound heard at the listener from the source's present position: to first
// order in the speeds the change of distance over c, and `excess` beyond that. With travel time, the source's track is
// delayed by that time, and the rate is exactly 1 less the change of distance over c.
Sighting Listening::sight(const Motion& source, const Vec3& origin_m, const Motion& listener) const REALTIME {
  constexpr double kMaxMach = 0.5;
  const Vec3 arm = rotated(source.pose.rotation, origin_m);
  const Vec3 way = listener.pose.position_m - (source.pose.position_m + arm);
  const double distance_m = length(way);
  const Vec3 along = distance_m > 1e-9 ? (1 / distance_m) * way : Vec3{1, 0, 0};
  const Vec3 velocity = source.velocity_m_s + cross(rotated(source.pose.rotation, source.spin_rad_s), arm);
  const auto mach = [&](Vec3 v) REALTIME { return std::clamp(dot(v, along) / sound_speed_m_s_, -kMaxMach, kMaxMach); };
  const double near = std::min(distance_m / kNear_m, 1.0);
  const double away = mach(listener.velocity_m_s), nearer = mach(velocity);
  Sighting seen{rotated(inverse(source.pose.rotation), along),
                near * rotated(inverse(listener.pose.rotation), -1.0 * along), distance_m};
  if (travel_time_) {
    seen.rate = 1 - away + nearer;
  } else {
    seen.rate = (1 - away) / (1 - nearer);
    seen.excess = (nearer - away) * nearer / (1 - nearer);
  }
  return seen;
}

void Listening::set_air(const modal::AirConditions& conditions) REALTIME {
  absorption_ = modal::AirAbsorption(conditions);
  sound_speed_m_s_ = modal::sound_speed_m_s(conditions);
  ++airs_;
}

void Listening::begin_cell(Frame begin, Frame end, double sample_rate_hz) REALTIME {
  track_.advance(begin, sample_rate_hz);
  begin_ = track_.at(begin, sample_rate_hz);
  end_ = track_.at(end, sample_rate_hz);
}

}  // namespace ringdown::synth
