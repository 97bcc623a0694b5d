// The pose of a body at any moment, interpolated between the poses that notices bring.
//
// Poses carry the scene's time. The window shows the scene with a small delay, so that there is always a later pose to
// interpolate towards:
//
//   DisplayClock clock(1 / 30.0);
//   clock.observe(now_s, notice.time_s, notice.paused);        // at every notice
//   track.add(notice.time_s, pose);                            // for every body in the notice
//   if (auto pose = track.pose_at(clock.time_at(now_s))) ...   // at every picture
//
// Times are in seconds: `now_s` of the computer's steady clock, `time_s` of the scene. [one thread]
#pragma once

#include "engine/base/vec3.h"

#include <cstddef>
#include <deque>
#include <optional>

namespace ringdown::viewer {

struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
  friend bool operator==(const Quaternion&, const Quaternion&) = default;
};

// Object frame -> scene frame.
struct Pose {
  Vec3 position_m;
  Quaternion rotation;  // of unit length
  friend bool operator==(const Pose&, const Pose&) = default;
};

// Interpolates positions linearly, and rotations at constant angular velocity the shortest way. Fraction 0 gives
// `from`, 1 gives `to`.
Pose between(const Pose& from, const Pose& to, double fraction);

class PoseHistory {
 public:
  static constexpr std::size_t kMaxPoses = 64;  // 2 s at 30 notices a second; older poses are dropped

  // Adds a pose. A pose at the time of the last one replaces it. Ignores an earlier pose, which is too late, as well as
  // numbers that are not finite and a rotation of length zero.
  void add(double time_s, Pose pose);

  // Forgets all poses: the body was moved elsewhere, or the scene's time has restarted.
  void restart() { poses_.clear(); }

  // Returns the pose at a time: exact at the times added, interpolated with constant velocities between them. Before
  // the first pose or after the last, returns that pose. Nothing for an empty track.
  [[nodiscard]] std::optional<Pose> pose_at(double time_s) const;

  [[nodiscard]] std::optional<double> last_time_s() const;

 private:
  struct TimedPose {
    double time_s;
    Pose pose;
  };
  std::deque<TimedPose> poses_;  // sorted by time
};

// Computes the scene time to show now. The time advances evenly although notices arrive unevenly, follows a scene that
// runs slowly, stands still while the scene is paused, and goes back only when the scene's time does.
class DisplayClock {
 public:
  static constexpr double kJump_s = 0.25;  // a notice this much earlier than the last one means that time restarted

  explicit DisplayClock(double notice_period_s) : period_s_(notice_period_s) {}

  enum class Course {
    onward,
    late,    // a later notice overtook this one: its poses are old
    jumped,  // time has jumped: tracks must restart
  };
  Course observe(double now_s, double time_s, bool paused);

  // Returns the time to show: at most the last notice's time; nothing before the first notice.
  std::optional<double> time_at(double now_s);

  // Returns the delay of the display: 1.5 notice periods, and more if notices arrive unevenly.
  [[nodiscard]] double delay_s() const;

  void restart();

 private:
  struct Reading {
    double now_s, time_s;
  };
  [[nodiscard]] double offset_s() const;

  static constexpr std::size_t kMaxReadings = 256;

  double period_s_;
  std::deque<Reading> readings_;  // one for each notice of the last second, since the scene last paused
  double last_time_s_ = 0, last_now_s_ = 0;
  bool has_time_ = false, paused_ = false;
  std::optional<Reading> shown_;
};

}  // namespace ringdown::viewer
