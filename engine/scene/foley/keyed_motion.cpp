#include "engine/scene/foley/keyed_motion.h"

#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>

namespace ringdown::scene {
namespace {

constexpr double kMaxTurn_rad = 0.1;  // in one step of the free turning motion

Rotation nearer(Rotation turn) {
  if (turn.w < 0) turn = Rotation::from_xyzw(-turn.x, -turn.y, -turn.z, -turn.w);
  return normalized(turn);
}

Vec3 way_between(const Rotation& from, const Rotation& to) { return to_rotation_vector(nearer(to * inverse(from))); }

}  // namespace

KeyedMotion::KeyedMotion(const MotionPath& path, const RigidMass& mass, Vec3 gravity_m_s2, std::size_t from,
                         const FoleyLimits& limits)
    : mass_(mass),
      inverse_inertia_(inverse(mass.inertia_kg_m2)),
      gravity_m_s2_(gravity_m_s2),
      every_s_(path.every_s),
      jitter_m_s_(limits.jitter_m_s) {
  for (const Pose& pose : path.poses)
    frames_.push_back({pose.position_m + rotated(pose.rotation, mass.center_m), normalized(pose.rotation)});
  for (std::size_t k = 0; k + 1 < frames_.size(); ++k) {
    Interval interval;
    interval.velocity_m_s = (1 / every_s_) * (frames_[k + 1].position_m - frames_[k].position_m);
    interval.momentum_nms = momentum_between(frames_[k].rotation, frames_[k + 1].rotation);
    interval.steady = k >= from;
    intervals_.push_back(interval);
  }
  find_jumps(std::sqrt((mass.inertia_kg_m2[0][0] + mass.inertia_kg_m2[1][1] + mass.inertia_kg_m2[2][2]) / mass.mass_kg),
             limits);
}

// A body jumps where it is faster than the limit, and where it goes farther than its own size in one interval but
// stands, in comparison, in both intervals beside it.
void KeyedMotion::find_jumps(double radius_m, const FoleyLimits& limits) {
  constexpr double kStands = 0.05;  // share of the speed of the jump
  std::vector<std::size_t> jumps;
  for (std::size_t k = 0; k < intervals_.size(); ++k) {
    const auto speed = [this](std::size_t at) { return length(intervals_[at].velocity_m_s); };
    const bool far = speed(k) * every_s_ > 2 * radius_m;
    const bool alone = k > 0 && k + 1 < intervals_.size() && std::max(speed(k - 1), speed(k + 1)) < kStands * speed(k);
    if (intervals_[k].steady && (speed(k) > limits.jump_m_s || (far && alone))) jumps.push_back(k);
  }
  for (const std::size_t k : jumps) intervals_[k].steady = false;
  jumps_ = jumps.size();
}

bool KeyedMotion::has_interval(std::size_t k) const {
  return !moves() || (k < intervals_.size() && intervals_[k].steady);
}

Push KeyedMotion::push(std::size_t k) const {
  if (!moves() || k == 0 || !has_interval(k - 1) || !has_interval(k)) return {};
  const Interval &before = intervals_[k - 1], &after = intervals_[k];
  return {mass_.mass_kg * (after.velocity_m_s - before.velocity_m_s - every_s_ * gravity_m_s2_),
          after.momentum_nms - before.momentum_nms};
}

bool KeyedMotion::turns_fast(std::size_t k) const {
  constexpr double kFast_rad = 1.8;
  const auto is_fast = [this](std::size_t interval) {
    return length(way_between(frames_[interval].rotation, frames_[interval + 1].rotation)) > kFast_rad;
  };
  return moves() && k > 0 && k < intervals_.size() && (is_fast(k - 1) || is_fast(k));
}

Matrix3 KeyedMotion::turned_inertia(const Rotation& rotation) const {
  const Matrix3 turn = to_matrix(rotation);
  return product(product(turn, inverse_inertia_), transpose(turn));
}

Matrix3 KeyedMotion::inverse_inertia(std::size_t k) const {
  return moves() ? turned_inertia(frames_[std::min(k, frames_.size() - 1)].rotation) : Matrix3{};
}

Vec3 KeyedMotion::spin(const Rotation& rotation, Vec3 momentum_nms) const {
  return turned_inertia(rotation) * momentum_nms;
}

// The midpoint rule: the spin of the middle of each step turns the body.
Rotation KeyedMotion::turn(const Rotation& from, Vec3 momentum_nms, double time_s) const {
  const double angle = length(spin(from, momentum_nms)) * std::abs(time_s);
  const int steps = std::clamp(static_cast<int>(std::ceil(angle / kMaxTurn_rad)), 1, 64);
  const double h = time_s / steps;
  Rotation at = from;
  for (int k = 0; k < steps; ++k) {
    const Rotation middle = normalized(from_rotation_vector(0.5 * h * spin(at, momentum_nms)) * at);
    at = normalized(from_rotation_vector(h * spin(middle, momentum_nms)) * at);
  }
  return at;
}

// Newton's method with the inertia of the middle in place of the derivative.
Vec3 KeyedMotion::momentum_between(const Rotation& from, const Rotation& to) const {
  constexpr int kMaxIterations = 8;
  const Vec3 way = way_between(from, to);
  const Matrix3 inertia = inverse(turned_inertia(normalized(from_rotation_vector(0.5 * way) * from)));
  Vec3 momentum = (1 / every_s_) * (inertia * way);
  for (int k = 0; k < kMaxIterations; ++k) {
    const Vec3 missed = way_between(turn(from, momentum, every_s_), to);
    momentum = momentum + (1 / every_s_) * (inertia * missed);
    if (!(length(missed) > 1e-9)) break;
  }
  return momentum;
}

Motion KeyedMotion::between(std::size_t k, double s) const {
  if (!moves()) return rest_;
  if (k >= intervals_.size()) return {frames_.back().position_m, frames_.back().rotation, {}, {}};
  const Pose &from = frames_[k], &to = frames_[k + 1];
  const Vec3 way = way_between(from.rotation, to.rotation);
  return {from.position_m + s * (to.position_m - from.position_m),
          normalized(from_rotation_vector(s * way) * from.rotation), intervals_[k].velocity_m_s, (1 / every_s_) * way};
}

// Returns true if only gravity acts around the frame.
bool KeyedMotion::is_free(std::size_t k) const {
  constexpr double kShare = 0.1;  // of the speed gained by falling for one frame
  return length(push(k).linear_ns) < mass_.mass_kg * (jitter_m_s_ + kShare * length(gravity_m_s2_) * every_s_);
}

Motion KeyedMotion::onward(std::size_t k, double s) const {
  if (!moves()) return rest_;
  if (k == 0 || k >= intervals_.size() || !has_interval(k - 1)) return between(k, s);
  const Interval& before = intervals_[k - 1];
  const bool falls = explained_ || (k >= 2 && is_free(k - 1));
  const Vec3 g = falls ? gravity_m_s2_ : Vec3{};
  const double t = s * every_s_;
  const Vec3 start = before.velocity_m_s + 0.5 * every_s_ * g + (1 / mass_.mass_kg) * before.after.linear_ns;
  const Vec3 momentum = before.momentum_nms + before.after.angular_nms;
  const Rotation rotation = turn(frames_[k].rotation, momentum, t);
  return {frames_[k].position_m + t * start + 0.5 * t * t * g, rotation, start + t * g, spin(rotation, momentum)};
}

Motion KeyedMotion::backward(std::size_t k, double s) const {
  if (!moves()) return rest_;
  if (k + 1 >= intervals_.size() || !has_interval(k + 1)) return between(k, s);
  const Interval& after = intervals_[k + 1];
  const bool falls = explained_ || (k + 2 < intervals_.size() && is_free(k + 2));
  const Vec3 g = falls ? gravity_m_s2_ : Vec3{};
  const double t = (s - 1) * every_s_;
  const Vec3 end = after.velocity_m_s - 0.5 * every_s_ * g - (1 / mass_.mass_kg) * after.before.linear_ns;
  const Vec3 momentum = after.momentum_nms - after.before.angular_nms;
  const Rotation rotation = turn(frames_[k + 1].rotation, momentum, t);
  return {frames_[k + 1].position_m + t * end + 0.5 * t * t * g, rotation, end + t * g, spin(rotation, momentum)};
}

Motion KeyedMotion::free_start(std::size_t k, double step_s) const {
  if (!moves()) return rest_;
  const Pose& from = frames_[k];
  const Vec3 velocity_m_s = intervals_[k].velocity_m_s - 0.5 * (every_s_ + step_s) * gravity_m_s2_;
  return {from.position_m, from.rotation, velocity_m_s, spin(from.rotation, intervals_[k].momentum_nms)};
}

void KeyedMotion::begin_explaining() {
  explained_ = true;
  for (Interval& interval : intervals_) interval.before = interval.after = {};
}

void KeyedMotion::explain(std::size_t k, const Push& before, const Push& after) {
  if (k >= intervals_.size()) return;
  const auto add = [](Push& sum, const Push& more) {
    sum.linear_ns = sum.linear_ns + more.linear_ns;
    sum.angular_nms = sum.angular_nms + more.angular_nms;
  };
  add(intervals_[k].before, before);
  add(intervals_[k].after, after);
}

}  // namespace ringdown::scene
