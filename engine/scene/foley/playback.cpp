#include "engine/scene/foley/playback.h"

#include <algorithm>
#include <cmath>

namespace ringdown::scene {

std::span<const ContactPoint> FoleyPlayback::step(double now_s, double step_s) {
  points_.clear();
  motions_.clear();
  while (next_blow_ < recovery_.blows.size() && recovery_.blows[next_blow_].time_s < now_s + step_s)
    play(recovery_.blows[next_blow_++], now_s);
  for (; next_step_ < recovery_.steps.size() && recovery_.steps[next_step_].time_s < now_s + step_s; ++next_step_) {
    const GuidedStep& step = recovery_.steps[next_step_];
    for (ContactPoint point : step.points) {
      point.found_s = std::max(step.time_s + point.found_s - now_s, 0.0);
      points_.push_back(point);
    }
  }
  const double middle = (now_s + 0.5 * step_s) / recovery_.every_s;
  const auto interval = static_cast<std::size_t>(middle);
  const auto& touches = recovery_.touches;
  while (first_touch_ < touches.size() && touches[first_touch_].interval < interval) ++first_touch_;
  for (std::size_t k = first_touch_; k < touches.size() && touches[k].interval == interval; ++k)
    play(touches[k], middle - static_cast<double>(interval), step_s);
  return points_;
}

bool FoleyPlayback::over(double now_s) const {
  const bool touches_over = recovery_.touches.empty() ||
                            now_s > static_cast<double>(recovery_.touches.back().interval + 1) * recovery_.every_s;
  return next_blow_ == recovery_.blows.size() && next_step_ == recovery_.steps.size() && touches_over;
}

void FoleyPlayback::play(const RecoveredBlow& blow, double now_s) {
  motions_.push_back(blow.motions);
  for (std::size_t p = 0; p < blow.points.size(); ++p) {
    points_.push_back({.body = blow.first,
                       .other = blow.second,
                       .point_m = blow.points[p].point_m,
                       .normal = blow.points[p].normal,
                       .impulse_ns = blow.impulses_ns[p],
                       .approach_m_s = blow.approach_m_s,
                       .found_s = std::max(blow.time_s - now_s, 0.0),
                       .motions = &motions_.back()});
  }
}

void FoleyPlayback::play(const RecoveredTouch& touch, double share, double step_s) {
  const FoleyBody &first = recovery_.bodies[touch.first], &second = recovery_.bodies[touch.second];
  motions_.push_back({first.motion.between(touch.interval, share), second.motion.between(touch.interval, share)});
  const Vec3 force_n = (1 - share) * touch.start_force_n + share * touch.end_force_n;
  const Vec3 shift_m = (1 - share) * touch.start_shift_m + share * touch.end_shift_m;
  for (std::size_t p = 0; p < touch.points.size(); ++p) {
    if (!(touch.shares[p] > 0)) continue;
    points_.push_back({.body = first.id,
                       .other = second.id,
                       .point_m = touch.points[p].point_m + shift_m,
                       .normal = touch.points[p].normal,
                       .impulse_ns = (touch.shares[p] * step_s) * force_n,
                       .motions = &motions_.back()});
  }
}

}  // namespace ringdown::scene
