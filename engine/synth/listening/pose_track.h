// Where something is and how it is turned, at every frame, from poses that come now and then. [audio, after
// construction]
//
// Between poses the track goes along cubic curves, so that velocity and spin are continuous and nothing is heard of the
// rate at which poses come. A pose that is known one interval before its frame is reached at its frame; one that comes
// later is reached one interval after it is known. A pose too far away to be reached by moving is jumped to.
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/rotation.h"
#include "engine/synth/event.h"

#include <array>
#include <cstddef>

namespace ringdown::synth {

// A pose and how it changes.
struct Motion {
  Pose pose;
  Vec3 velocity_m_s;  // in the scene's axes
  Vec3 spin_rad_s;    // in the moving thing's own axes
};

// Whether every number of a pose is finite, positions are at most kMaxPosition_m, and the rotation has a direction.
inline constexpr double kMaxPosition_m = 1e6;
[[nodiscard]] bool is_sane(const Pose& pose) RINGDOWN_REALTIME;

class PoseTrack {
 public:
  static constexpr double kMaxSpeed_m_s = 120;    // what would have to move faster jumps
  static constexpr double kMaxInterval_s = 0.1;   // poses farther apart are not one motion
  static constexpr double kLonePose_s = 0.03;     // the time in which a pose that follows no other soon is reached
  static constexpr std::size_t kMaxPending = 96;  // poses that wait for their frames: 500 a second in a block of 8,192

  [[nodiscard]] bool known() const RINGDOWN_REALTIME { return known_; }
  void forget() RINGDOWN_REALTIME { *this = {}; }

  // Adds a pose, which is sane, for frame `at`, at frame `now`. The first pose is where the track starts. Where nobody
  // has asked for the track for a while, poses that have passed make room; of more than kMaxPending the last one
  // counts.
  void add(Frame at, const Pose& pose, Frame now, double sample_rate_hz) RINGDOWN_REALTIME;

  // Goes on to frame `now`, which never decreases.
  void advance(Frame now, double sample_rate_hz) RINGDOWN_REALTIME;
  // Where it is at a frame from the last advance() on, as far as is known by then.
  [[nodiscard]] Motion at(Frame frame, double sample_rate_hz) const RINGDOWN_REALTIME;
  // Whether it stands from the last advance() on until another pose comes.
  [[nodiscard]] bool still() const RINGDOWN_REALTIME { return still_ && count_ == 0; }
  // Whether it turns at most, and keeps its position until the next advance().
  [[nodiscard]] bool stays_in_place() const RINGDOWN_REALTIME {
    return from_.pose.position_m == to_.pose.position_m && from_.velocity == Vec3{} && to_.velocity == Vec3{};
  }
  // How often it has jumped.
  [[nodiscard]] std::uint32_t jumps() const RINGDOWN_REALTIME { return jumps_; }

  // After a change of the sample rate at frame `now`: it stands where it was going to. [worker]
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
  void begin_curve(Frame now, double sample_rate_hz) RINGDOWN_REALTIME;
  void catch_up(Frame now, double sample_rate_hz) RINGDOWN_REALTIME;
  void come_to_rest(Frame now) RINGDOWN_REALTIME;
  [[nodiscard]] End end_at(const Key& key, const Key* next, double longest) const RINGDOWN_REALTIME;
  [[nodiscard]] End state_at(Frame frame) const RINGDOWN_REALTIME;

  std::array<Key, kMaxPending> pending_{};  // by frame
  std::size_t count_ = 0;
  std::array<Key, 2> reached_{};  // the last poses that the track has gone to, the latest first
  std::size_t reached_count_ = 0;
  End from_, to_;
  Vec3 turn_;  // from one rotation to the other, in the axes of the first
  Frame begin_ = 0, end_ = 0;
  Frame now_ = 0;
  bool known_ = false, still_ = true;
  std::uint32_t jumps_ = 0;
};

}  // namespace ringdown::synth
