#include "clients/viewer/link/pose_track.h"

#include <algorithm>
#include <cmath>

namespace ringdown::viewer {
namespace {

constexpr double kWindow_s = 1;         // the clock is fitted to the notices of this much time
constexpr double kForwardJump_s = 0.5;  // a notice this much ahead of the elapsed time means that time jumped
constexpr double kMaxPeriodsLate = 4;
constexpr double kFarOff_s = 0.5;  // a larger error sets the clock instead of speeding it up
constexpr double kNear_s = 0.1;    // smaller errors are corrected at 10 % of the speed, larger ones at 50 %

double dot(const Quaternion& a, const Quaternion& b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }

Quaternion sum(double s, const Quaternion& a, double t, const Quaternion& b) {
  return {s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z, s * a.w + t * b.w};
}

Quaternion unit(const Quaternion& q) { return sum(1 / std::sqrt(dot(q, q)), q, 0, q); }

// Spherical linear interpolation of two unit quaternions, the shorter way round (Shoemake, SIGGRAPH 1985); q and -q are
// the same rotation. Nearly equal ones are interpolated in a straight line, where the sine of the angle vanishes.
Quaternion turn_between(const Quaternion& from, const Quaternion& to, double fraction) {
  const double sign = dot(from, to) < 0 ? -1 : 1;
  const double cosine = std::min(1.0, sign * dot(from, to));
  if (cosine > 1 - 1e-9) return unit(sum(1 - fraction, from, sign * fraction, to));
  const double angle = std::acos(cosine);
  const double s = std::sin((1 - fraction) * angle), t = std::sin(fraction * angle);
  return unit(sum(s, from, sign * t, to));
}

}  // namespace

Pose between(const Pose& from, const Pose& to, double fraction) {
  return {(1 - fraction) * from.position_m + fraction * to.position_m,
          turn_between(from.rotation, to.rotation, fraction)};
}

void PoseHistory::add(double time_s, Pose pose) {
  const double norm = dot(pose.rotation, pose.rotation);
  if (!std::isfinite(time_s) || !is_finite(pose.position_m) || !std::isfinite(norm) || norm < 1e-6) return;
  if (!poses_.empty() && time_s < poses_.back().time_s) return;
  pose.rotation = unit(pose.rotation);
  if (!poses_.empty() && time_s == poses_.back().time_s) poses_.pop_back();
  poses_.push_back({time_s, pose});
  if (poses_.size() > kMaxPoses) poses_.pop_front();
}

std::optional<Pose> PoseHistory::pose_at(double time_s) const {
  if (poses_.empty()) return std::nullopt;
  const auto next = std::ranges::lower_bound(poses_, time_s, {}, &TimedPose::time_s);
  if (next == poses_.end()) return poses_.back().pose;
  if (next == poses_.begin() || next->time_s == time_s) return next->pose;
  const TimedPose& last = *std::prev(next);
  return between(last.pose, next->pose, (time_s - last.time_s) / (next->time_s - last.time_s));
}

std::optional<double> PoseHistory::last_time_s() const {
  return poses_.empty() ? std::nullopt : std::optional(poses_.back().time_s);
}

DisplayClock::Course DisplayClock::observe(double now_s, double time_s, bool paused) {
  Course course = Course::onward;
  if (has_time_) {
    const double passed_s = std::max(0.0, now_s - last_now_s_);
    const bool jumped = time_s < last_time_s_ - kJump_s || time_s > last_time_s_ + passed_s + kForwardJump_s;
    if (!jumped && time_s < last_time_s_) return Course::late;
    if (jumped) {
      course = Course::jumped;
      restart();
    }
  }
  if (paused || paused_) readings_.clear();
  if (!paused) readings_.push_back({now_s, time_s});
  while (!readings_.empty() && readings_.front().now_s < now_s - kWindow_s) readings_.pop_front();
  if (readings_.size() > kMaxReadings) readings_.pop_front();
  has_time_ = true;
  paused_ = paused;
  last_time_s_ = time_s;
  last_now_s_ = now_s;
  return course;
}

// Returns how far scene time is ahead of our clock. A delayed notice makes the difference too small, never too large,
// so the largest difference of the last kWindow_s belongs to the shortest delay and is the best estimate: the minimum
// filter of network clocks, as in NTP.
double DisplayClock::offset_s() const {
  double largest = readings_.front().time_s - readings_.front().now_s;
  for (const Reading& reading : readings_) largest = std::max(largest, reading.time_s - reading.now_s);
  return largest;
}

// Returns how far the shown time stays behind the scene: a period, since the next notice must have arrived before a
// pose can be interpolated, plus the spread of the delays seen in the last kWindow_s; at least 1.5 and at most
// kMaxPeriodsLate periods.
double DisplayClock::delay_s() const {
  if (readings_.empty()) return 1.5 * period_s_;
  const double largest = offset_s();
  double spread_s = 0;
  for (const Reading& reading : readings_) spread_s = std::max(spread_s, largest - (reading.time_s - reading.now_s));
  return std::clamp(period_s_ + spread_s, 1.5 * period_s_, kMaxPeriodsLate * period_s_);
}

// The target is the scene time now, less the delay. The shown time runs with our clock and is corrected towards the
// target by running up to 10 % faster or slower, or up to 50 % for larger errors, so that motion looks even. If the
// target is half a second ahead, the time jumps to it.
std::optional<double> DisplayClock::time_at(double now_s) {
  if (!has_time_) return std::nullopt;
  const bool stands = paused_ || readings_.empty();
  const double target_s = stands ? last_time_s_ : std::min(last_time_s_, now_s + offset_s() - delay_s());
  if (!shown_) {
    shown_ = {now_s, target_s};
    return target_s;
  }
  const double passed_s = std::max(0.0, now_s - shown_->now_s);
  const double error_s = target_s - (shown_->time_s + passed_s);
  double next_s = target_s;
  if (error_s < kFarOff_s) {
    const double haste = std::abs(error_s) < kNear_s ? 0.1 : 0.5;
    const double correction_s = stands ? 0 : std::clamp(error_s, -haste * passed_s, haste * passed_s);
    next_s = std::min(shown_->time_s + passed_s + correction_s, last_time_s_);
  }
  shown_ = {std::max(now_s, shown_->now_s), std::max(shown_->time_s, next_s)};
  return shown_->time_s;
}

void DisplayClock::restart() {
  readings_.clear();
  shown_.reset();
  has_time_ = paused_ = false;
}

}  // namespace ringdown::viewer
