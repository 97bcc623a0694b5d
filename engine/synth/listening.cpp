#include "engine/synth/listening.h"

#include <algorithm>
#include <cmath>

namespace ringdown::synth {

Sighting sight(const Motion& source, const Vec3& origin_m, const Motion& listener,
               double sound_speed_m_s) RINGDOWN_REALTIME {
  constexpr double kMaxMach = 0.5;
  const Vec3 arm = rotated(source.pose.rotation, origin_m);
  const Vec3 way = listener.pose.position_m - (source.pose.position_m + arm);
  const double distance_m = length(way);
  const Vec3 along = distance_m > 1e-9 ? (1 / distance_m) * way : Vec3{1, 0, 0};
  const Vec3 velocity = source.velocity_m_s + cross(rotated(source.pose.rotation, source.spin_rad_s), arm);
  const auto mach = [&](Vec3 v)
                        RINGDOWN_REALTIME { return std::clamp(dot(v, along) / sound_speed_m_s, -kMaxMach, kMaxMach); };
  const double near = std::min(distance_m / kNear_m, 1.0);
  const double away = mach(listener.velocity_m_s), nearer = mach(velocity);
  return {rotated(inverse(source.pose.rotation), along), near * rotated(inverse(listener.pose.rotation), -1.0 * along),
          distance_m, (1 - away) / (1 - nearer), (nearer - away) * nearer / (1 - nearer)};
}

void Listening::set_air(const modal::AirConditions& conditions) RINGDOWN_REALTIME {
  absorption_ = modal::AirAbsorption(conditions);
  sound_speed_m_s_ = modal::sound_speed_m_s(conditions);
  ++airs_;
}

void Listening::begin_chunk(Frame begin, std::size_t frames, double sample_rate_hz) RINGDOWN_REALTIME {
  track_.advance(begin, sample_rate_hz);
  begin_ = track_.at(begin, sample_rate_hz);
  end_ = track_.at(begin + static_cast<Frame>(frames), sample_rate_hz);
}

}  // namespace ringdown::synth
