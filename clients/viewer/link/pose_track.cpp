#include "clients/viewer/link/pose_track.h"

#include <algorithm>
#include <cmath>

namespace ringdown::viewer {
namespace {

constexpr double kWindow_s = 1;         // of notices that say how scene time and ours belong together
constexpr double kForwardJump_s = 0.5;  // more than the time that has passed
constexpr double kMaxPeriodsLate = 4;
constexpr double kFarOff_s = 0.5;  // there the clock is set rather than hurried
constexpr double kNear_s = 0.1;

double dot(const Quaternion& a, const Quaternion& b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }

Quaternion sum(double s, const Quaternion& a, double t, const Quaternion& b) {
  return {s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z, s * a.w + t * b.w};
}

Quaternion unit(const Quaternion& q) { return sum(1 / std::sqrt(dot(q, q)), q, 0, q); }

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

void PoseTrack::tell(double time_s, Pose pose) {
  const double norm = dot(pose.rotation, pose.rotation);
  if (!std::isfinite(time_s) || !is_finite(pose.position_m) || !std::isfinite(norm) || norm < 1e-6) return;
  if (!told_.empty() && time_s < told_.back().time_s) return;
  pose.rotation = unit(pose.rotation);
  if (!told_.empty() && time_s == told_.back().time_s) told_.pop_back();
  told_.push_back({time_s, pose});
  if (told_.size() > kMaxPoses) told_.pop_front();
}

std::optional<Pose> PoseTrack::pose_at(double time_s) const {
  if (told_.empty()) return std::nullopt;
  const auto next = std::ranges::lower_bound(told_, time_s, {}, &Told::time_s);
  if (next == told_.end()) return told_.back().pose;
  if (next == told_.begin() || next->time_s == time_s) return next->pose;
  const Told& last = *std::prev(next);
  return between(last.pose, next->pose, (time_s - last.time_s) / (next->time_s - last.time_s));
}

std::optional<double> PoseTrack::last_told_s() const {
  return told_.empty() ? std::nullopt : std::optional(told_.back().time_s);
}

DisplayClock::Course DisplayClock::observe(double now_s, double time_s, bool paused) {
  Course course = Course::onward;
  if (told_) {
    const double passed_s = std::max(0.0, now_s - last_heard_s_);
    const bool jumped = time_s < last_time_s_ - kJump_s || time_s > last_time_s_ + passed_s + kForwardJump_s;
    if (!jumped && time_s < last_time_s_) return Course::late;
    if (jumped) {
      course = Course::anew;
      restart();
    }
  }
  if (paused || paused_) heard_.clear();
  if (!paused) heard_.push_back({now_s, time_s});
  while (!heard_.empty() && heard_.front().now_s < now_s - kWindow_s) heard_.pop_front();
  if (heard_.size() > kMaxHeard) heard_.pop_front();
  told_ = true;
  paused_ = paused;
  last_time_s_ = time_s;
  last_heard_s_ = now_s;
  return course;
}

// The notice that took the shortest way says best how far scene time is ahead of ours.
double DisplayClock::offset_s() const {
  double largest = heard_.front().time_s - heard_.front().now_s;
  for (const Heard& heard : heard_) largest = std::max(largest, heard.time_s - heard.now_s);
  return largest;
}

double DisplayClock::delay_s() const {
  if (heard_.empty()) return 1.5 * period_s_;
  const double largest = offset_s();
  double spread_s = 0;
  for (const Heard& heard : heard_) spread_s = std::max(spread_s, largest - (heard.time_s - heard.now_s));
  return std::clamp(period_s_ + spread_s, 1.5 * period_s_, kMaxPeriodsLate * period_s_);
}

std::optional<double> DisplayClock::time_at(double now_s) {
  if (!told_) return std::nullopt;
  const bool stands = paused_ || heard_.empty();
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
  heard_.clear();
  shown_.reset();
  told_ = paused_ = false;
}

}  // namespace ringdown::viewer
