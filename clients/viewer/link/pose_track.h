// Where a body is at any moment, from poses that are told now and then.
//
// Poses carry the scene's time. They are shown a little late, so that there are always two to go between:
//
//   DisplayClock clock(1 / 30.0);
//   clock.observe(now_s, notice.time_s, notice.paused);        // at every notice
//   track.tell(notice.time_s, pose);                           // of every body in it
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

// Positions linearly, rotations at constant angular velocity the shortest way; 0 gives `from`, 1 gives `to`.
Pose between(const Pose& from, const Pose& to, double fraction);

class PoseTrack {
 public:
  static constexpr std::size_t kMaxPoses = 64;  // 2 s at 30 notices a second; the oldest goes

  // A pose at the time told last replaces it, an earlier one comes too late and is ignored. Numbers that are not
  // finite, and a rotation without a direction, are ignored too.
  void tell(double time_s, Pose pose);

  // Forgets what was told: the body has been put somewhere else, or time has begun anew.
  void restart() { told_.clear(); }

  // Exact at the times told, and between them for constant velocity; before the first and after the last, that one.
  // Nothing when nothing was told.
  [[nodiscard]] std::optional<Pose> pose_at(double time_s) const;

  [[nodiscard]] std::optional<double> last_told_s() const;

 private:
  struct Told {
    double time_s;
    Pose pose;
  };
  std::deque<Told> told_;  // by time
};

// What scene time to show now. It runs evenly although notices arrive unevenly, follows a scene that is slowed down,
// stands while the scene is paused, and never goes back unless the scene's time does.
class DisplayClock {
 public:
  static constexpr double kJump_s = 0.25;  // a time this far before the last one told is a new beginning

  explicit DisplayClock(double notice_period_s) : period_s_(notice_period_s) {}

  enum class Course {
    onward,
    late,  // the notice was overtaken by a later one: its poses are old
    anew,  // time has jumped: tracks must restart
  };
  Course observe(double now_s, double time_s, bool paused);

  // Never after the time told last; nothing before the first one.
  std::optional<double> time_at(double now_s);

  // How late it shows: 1.5 notice periods, and more where notices arrive unevenly.
  [[nodiscard]] double delay_s() const;

  void restart();

 private:
  struct Heard {
    double now_s, time_s;
  };
  [[nodiscard]] double offset_s() const;

  static constexpr std::size_t kMaxHeard = 256;

  double period_s_;
  std::deque<Heard> heard_;  // of the last second, since the scene last stood
  double last_time_s_ = 0, last_heard_s_ = 0;
  bool told_ = false, paused_ = false;
  std::optional<Heard> shown_;
};

}  // namespace ringdown::viewer
