// Interpolates position and rotation at every frame from poses that arrive at irregular times. [audio, after
// construction]
//
// Between poses the track follows cubic curves, so that velocity and spin are continuous and the rate of poses is
// inaudible. A pose known one interval before its frame is reached at its frame; a later one is reached one interval
// after it becomes known. If a pose is too far away to be reached by moving, the track jumps.
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/rotation.h"
#include "engine/synth/events/event.h"

#include <array>
#include <cstddef>

namespace ringdown::synth {

// A pose and its rate of change.
struct Motion {
  Pose pose;
  Vec3 velocity_m_s;  // in the scene's axes
  Vec3 spin_rad_s;    // in the moving thing's own axes
};

// Returns whether every number of a pose is finite, positions are at most kMaxPosition_m, and the rotation has a
// direction.
inline constexpr double kMaxPosition_m = 1e6;
[[nodiscard]] bool is_sane(const Pose& pose) REALTIME;

class PoseTrack {
 public:
  static constexpr double kMaxSpeed_m_s = 120;    // faster motions become jumps
  static constexpr double kMaxInterval_s = 0.1;   // poses farther apart are not one motion
  static constexpr double kLonePose_s = 0.03;     // duration of the motion to an isolated pose
  static constexpr std::size_t kMaxPending = 96;  // poses waiting for their frames: 500 a second in a block of 8,192

  [[nodiscard]] bool known() const REALTIME { return known_; }

  // Adds a sane pose for frame `at`, at frame `now`. The track starts at the first pose. If the track has not been read
  // for a while, poses in the past make room. If kMaxPending poses wait already, the new one replaces the last.
  void add(Frame at, const Pose& pose, Frame now, double sample_rate_hz) REALTIME;

  // Advances to frame `now`, which never decreases.
  void advance(Frame now, double sample_rate_hz) REALTIME;
  // Returns the motion at a frame from the last advance() on, as far as it was known then.
  [[nodiscard]] Motion at(Frame frame, double sample_rate_hz) const REALTIME;
  // Returns whether the track stands still from the last advance() until another pose comes.
  [[nodiscard]] bool still() const REALTIME { return still_ && count_ == 0; }
  // Returns whether the position is constant until the next advance(); the track may turn.
  [[nodiscard]] bool stays_in_place() const REALTIME {
    return from_.pose.position_m == to_.pose.position_m && from_.velocity == Vec3{} && to_.velocity == Vec3{};
  }
  // Returns the number of jumps so far.
  [[nodiscard]] std::uint32_t jumps() const REALTIME { return jumps_; }

  // Call after a change of the sample rate at frame `now`. The track then stands at its latest pose. [worker]
  void rescale(Frame now);

 private:
  struct Key {
    Frame at = 0;
    Pose pose;
  };
  // A state at one end of a curve; velocity and spin per frame.
  struct End {
    Pose pose;
    Vec3 velocity, spin;
  };
  void begin_curve(Frame now, double sample_rate_hz) REALTIME;
  void catch_up(Frame now, double sample_rate_hz) REALTIME;
  void come_to_rest(Frame now) REALTIME;
  [[nodiscard]] End end_at(const Key& key, const Key* next, double longest) const REALTIME;
  [[nodiscard]] End state_at(Frame frame) const REALTIME;

  std::array<Key, kMaxPending> pending_{};  // sorted by frame
  std::size_t count_ = 0;
  std::array<Key, 2> reached_{};  // last poses that the track has reached, the latest first
  std::size_t reached_count_ = 0;
  End from_, to_;
  Vec3 turn_;  // rotation vector from from_ to to_, in the axes of from_
  Frame begin_ = 0, end_ = 0;
  Frame now_ = 0;
  bool known_ = false, still_ = true;
  std::uint32_t jumps_ = 0;
};

}  // namespace ringdown::synth
