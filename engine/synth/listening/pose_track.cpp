#include "engine/synth/listening/pose_track.h"

#include <algorithm>
#include <cmath>
#include <utility>

// A curve leads from one end to the other: positions by Hermite's cubic, rotations by the same cubic for the rotation
// vector relative to the first end's rotation. It begins with the final velocity of the previous curve. The velocity at
// its far end is found from the poses around that end: from both neighbours if the next pose is known already, as for
// poses sent ahead of their frames, and otherwise from the last three. A curve is never shorter than the interval
// between its pose and the previous one, or the motion would be too fast; if overdue poses wait, it is a quarter
// shorter.  If no next pose is known at its end, a curve that comes to rest follows.
namespace ringdown::synth {
namespace {

struct Cubic {
  double from, to, begin, end;  // weights of the two places and of the two velocities
};

// Hermite's polynomials over `length` frames at the share t of the way, and their derivatives per frame.
Cubic cubic(double t, double length) REALTIME {
  const double t2 = t * t, t3 = t2 * t;
  return {2 * t3 - 3 * t2 + 1, 3 * t2 - 2 * t3, (t3 - 2 * t2 + t) * length, (t3 - t2) * length};
}
Cubic cubic_slope(double t, double length) REALTIME {
  const double t2 = t * t;
  return {6 * (t2 - t) / length, 6 * (t - t2) / length, 3 * t2 - 4 * t + 1, 3 * t2 - 2 * t};
}

Vec3 mix(const Cubic& c, Vec3 from, Vec3 to, Vec3 begin, Vec3 end) REALTIME {
  return c.from * from + c.to * to + c.begin * begin + c.end * end;
}

// The way from one rotation to another, in the axes of the first.
Vec3 turn_between(const Rotation& from, const Rotation& to) REALTIME { return to_rotation_vector(inverse(from) * to); }

}  // namespace

bool is_sane(const Pose& pose) REALTIME {
  const Vec3& p = pose.position_m;
  const double size = norm(pose.rotation);
  return std::abs(p.x) <= kMaxPosition_m && std::abs(p.y) <= kMaxPosition_m && std::abs(p.z) <= kMaxPosition_m &&
         size >= 1e-6 && size <= 1e6;
}

void PoseTrack::add(Frame at, const Pose& pose, Frame now, double sample_rate_hz) REALTIME {
  const Key key{at, {pose.position_m, normalized(pose.rotation)}};
  if (!known_) {
    known_ = true;
    from_ = to_ = {key.pose, {}, {}};
    begin_ = end_ = now_ = at;
    reached_[0] = key;
    reached_count_ = 1;
    return;
  }
  if (count_ == kMaxPending && static_cast<double>(now - now_) > kMaxInterval_s * sample_rate_hz) {
    catch_up(now, sample_rate_hz);
    now_ = now;
  }
  std::size_t place = count_;
  while (place > 0 && pending_[place - 1].at > at) --place;
  if (place > 0 && pending_[place - 1].at == at) {
    pending_[place - 1] = key;
    return;
  }
  if (count_ == kMaxPending) {
    pending_[kMaxPending - 1] = key;
    return;
  }
  std::move_backward(pending_.data() + place, pending_.data() + count_, pending_.data() + count_ + 1);
  pending_[place] = key;
  ++count_;
}

void PoseTrack::advance(Frame now, double sample_rate_hz) REALTIME {
  if (known_ && static_cast<double>(now - now_) > kMaxInterval_s * sample_rate_hz) catch_up(now, sample_rate_hz);
  now_ = now;
  while (known_ && end_ <= now && (count_ > 0 || !still_)) {
    begin_curve(std::max(end_, begin_), sample_rate_hz);
    turn_ = turn_between(from_.pose.rotation, to_.pose.rotation);
  }
}

// Skips the time in which the track was not read. It continues from the last pose that was due, at that pose's own
// frame; otherwise it would lag behind for as long as poses come.
void PoseTrack::catch_up(Frame now, double sample_rate_hz) REALTIME {
  std::size_t passed = 0;
  for (; passed < count_ && pending_[passed].at <= now; ++passed) {
    reached_[1] = reached_[0];
    reached_[0] = pending_[passed];
  }
  if (passed == 0 && still_) return;
  std::move(pending_.data() + passed, pending_.data() + count_, pending_.data());
  count_ -= passed;
  reached_count_ = passed > 1 ? 2 : 1;
  to_ = {passed > 0 ? reached_[0].pose : to_.pose, {}, {}};
  const double longest = kMaxInterval_s * sample_rate_hz;
  const bool lately = passed > 0 && static_cast<double>(now - reached_[0].at) <= longest;
  if (passed > 1 && lately) {
    const Key before = std::exchange(reached_[0], reached_[1]);
    to_ = end_at(before, count_ > 0 ? pending_.data() : nullptr, longest);
    reached_[0] = before;
  }
  from_ = to_;
  begin_ = end_ = lately ? reached_[0].at : now;
  still_ = dot(to_.velocity, to_.velocity) + dot(to_.spin, to_.spin) == 0;
}

// The track has come to the end of its curve: chooses the next one.
void PoseTrack::begin_curve(Frame now, double sample_rate_hz) REALTIME {
  const double longest = kMaxInterval_s * sample_rate_hz;
  from_ = to_;
  const bool moves = dot(from_.velocity, from_.velocity) + dot(from_.spin, from_.spin) > 0;
  const Frame gap = count_ > 0 ? pending_[0].at - reached_[0].at : 0;
  const bool alone = gap <= 0 || static_cast<double>(gap) > longest;
  Frame interval = gap;
  if (alone) {  // how fast its thing moves is told by the pose after it
    interval = static_cast<Frame>(kLonePose_s * sample_rate_hz);
    if (count_ > 1) interval = std::min(interval, pending_[1].at - pending_[0].at);
  }
  if (count_ == 0 || (alone && moves && pending_[0].at - interval > now)) {
    come_to_rest(now);
    return;
  }
  if (still_) now = std::max(now, now_);  // it has stood since the last curve
  const Key key = pending_[0];
  const double speed =
      sample_rate_hz * length(key.pose.position_m - from_.pose.position_m) / static_cast<double>(interval);
  const bool jumps = speed > kMaxSpeed_m_s;
  if (jumps && key.at > now) {  // not before its frame
    to_ = from_ = {from_.pose, {}, {}};
    begin_ = now;
    end_ = key.at;
    still_ = false;
    return;
  }
  std::move(pending_.data() + 1, pending_.data() + count_, pending_.data());
  --count_;
  const bool hurries = key.at <= now && count_ > 0;
  begin_ = alone ? std::max(now, key.at - interval) : now;
  end_ = std::max(key.at, begin_ + (hurries ? interval - interval / 4 : interval));
  to_ = end_at(key, count_ > 0 ? pending_.data() : nullptr, longest);
  reached_[1] = reached_[0];
  reached_[0] = key;
  reached_count_ = alone ? 1 : 2;
  still_ = false;
  if (!jumps) return;
  ++jumps_;
  from_ = to_ = {key.pose, {}, {}};
  reached_count_ = 1;
  end_ = begin_ + 1;
}

// A curve that ends at rest, as long as the one before.
void PoseTrack::come_to_rest(Frame now) REALTIME {
  const Frame frames = std::max<Frame>(end_ - begin_, 1);
  still_ = dot(from_.velocity, from_.velocity) + dot(from_.spin, from_.spin) == 0;
  begin_ = now;
  end_ = still_ ? now : now + frames;
  if (still_) return;
  const double half = 0.5 * static_cast<double>(frames);
  to_ = {{from_.pose.position_m + half * from_.velocity,
          normalized(from_.pose.rotation * from_rotation_vector(half * from_.spin))},
         {},
         {}};
}

// The motion that the track should have when it reaches a pose.
PoseTrack::End PoseTrack::end_at(const Key& key, const Key* next, double longest) const REALTIME {
  End end{key.pose, {}, {}};
  const auto before = static_cast<double>(key.at - reached_[0].at);
  if (!(before > 0 && before <= longest)) return end;
  const double per_before = 1 / before;
  const Vec3 way = per_before * (key.pose.position_m - reached_[0].pose.position_m);
  const Vec3 turn = per_before * turn_between(reached_[0].pose.rotation, key.pose.rotation);
  Vec3 bend{}, twist{};  // by how much velocity and spin change beyond those of the last interval
  const double after = next ? static_cast<double>(next->at - key.at) : 0.0;
  if (after > 0 && after <= longest) {
    const double share = before / (before + after);
    bend = share * ((1 / after) * (next->pose.position_m - key.pose.position_m) - way);
    twist = share * ((1 / after) * turn_between(key.pose.rotation, next->pose.rotation) - turn);
  } else if (reached_count_ > 1) {
    const auto earlier = static_cast<double>(reached_[0].at - reached_[1].at);
    if (earlier > 0 && earlier <= longest) {
      const double share = before / (before + earlier);
      bend = share * (way - (1 / earlier) * (reached_[0].pose.position_m - reached_[1].pose.position_m));
      twist = share * (turn - (1 / earlier) * turn_between(reached_[1].pose.rotation, reached_[0].pose.rotation));
    }
  }
  end.velocity = way + bend;
  end.spin = turn + twist;
  return end;
}

PoseTrack::End PoseTrack::state_at(Frame frame) const REALTIME {
  if (frame >= end_ || end_ <= begin_) {
    if (still_) return {to_.pose, {}, {}};
    const auto beyond = static_cast<double>(frame - end_);
    return {{to_.pose.position_m + beyond * to_.velocity,
             normalized(to_.pose.rotation * from_rotation_vector(beyond * to_.spin))},
            to_.velocity,
            to_.spin};
  }
  const auto length = static_cast<double>(end_ - begin_);
  const double t = static_cast<double>(std::max<Frame>(frame - begin_, 0)) / length;
  const Cubic place = cubic(t, length), slope = cubic_slope(t, length);
  const Vec3 turned = mix(place, {}, turn_, from_.spin, to_.spin);
  return {{mix(place, from_.pose.position_m, to_.pose.position_m, from_.velocity, to_.velocity),
           normalized(from_.pose.rotation * from_rotation_vector(turned))},
          mix(slope, from_.pose.position_m, to_.pose.position_m, from_.velocity, to_.velocity),
          mix(slope, {}, turn_, from_.spin, to_.spin)};
}

Motion PoseTrack::at(Frame frame, double sample_rate_hz) const REALTIME {
  const End state = state_at(frame);
  return {state.pose, sample_rate_hz * state.velocity, sample_rate_hz * state.spin};
}

void PoseTrack::rescale(Frame now) {
  if (!known_) return;
  const Pose pose = count_ > 0 ? pending_[count_ - 1].pose : to_.pose;
  const std::uint32_t jumps = jumps_;
  *this = {};
  add(now, pose, now, 1);
  jumps_ = jumps + 1;
}

}  // namespace ringdown::synth
