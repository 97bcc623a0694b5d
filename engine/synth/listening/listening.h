// The listener: position and direction, and how a source reaches them. [audio, after construction]
//
// The listener's own frame has x to the front, y to the left and z up, as in ambisonics.
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/rotation.h"
#include "engine/modal/air_absorption.h"
#include "engine/synth/listening/pose_track.h"

#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

// Direction and distance between a source and the listener at one moment.
struct Sighting {
  Vec3 toward_listener;  // unit, in the source's frame
  Vec3 toward_source;    // in the listener's frame; length 1, or less if nearer than kNear_m
  double distance_m = 1;
  double rate = 1;    // factor on frequencies (Doppler)
  double excess = 0;  // rate - (1 - (change of distance) / c): of second order in speeds over c
};

// Distance at which sources have their own level; nearer sources are not louder.
inline constexpr double kReferenceDistance_m = 1;
// Sources nearer than this are heard less and less from one direction.
inline constexpr double kNear_m = 0.25;

inline double level_at(double distance_m) REALTIME {
  return kReferenceDistance_m / (distance_m > kReferenceDistance_m ? distance_m : kReferenceDistance_m);
}

class Listening {
 public:
  Listening() { set_air({}); }

  [[nodiscard]] bool on() const REALTIME { return on_; }
  // Returns whether there has ever been a listener.
  [[nodiscard]] bool used() const REALTIME { return track_.known(); }
  void place(Frame at, const Pose& pose, Frame now, double sample_rate_hz) REALTIME {
    track_.add(at, pose, now, sample_rate_hz);
    on_ = true;
  }
  void leave() REALTIME { on_ = false; }
  // Sets whether sounds arrive later by their travel time. If so, a source's poses must be delivered later by this
  // time, too, so that its track shows its position when the sound left it. [worker, while nothing is rendered]
  void set_travel_time(bool on) { travel_time_ = on; }
  [[nodiscard]] bool travel_time() const REALTIME { return travel_time_ && on_; }
  // Returns the travel time of sound, in frames, from `from_m` to the listener's position at frame `heard`, which must
  // not lie before the last cell.
  [[nodiscard]] double travel_frames(const Vec3& from_m, Frame heard, double sample_rate_hz) const REALTIME {
    return length(track_.at(heard, sample_rate_hz).pose.position_m - from_m) / sound_speed_m_s_ * sample_rate_hz;
  }
  void set_air(const modal::AirConditions& conditions) REALTIME;
  void rescale(Frame now) { track_.rescale(now); }  // [worker]

  // Call before every chunk of a cell (chunk.h).
  void begin_cell(Frame begin, Frame end, double sample_rate_hz) REALTIME;
  // The functions below are valid from begin_cell() on, for the cell's first frame, the frame after its last, or any
  // frame from the first on.
  [[nodiscard]] const Motion& at_begin() const REALTIME { return begin_; }
  [[nodiscard]] const Motion& at_end() const REALTIME { return end_; }
  [[nodiscard]] Motion at(Frame frame, double sample_rate_hz) const REALTIME {
    return track_.at(frame, sample_rate_hz);
  }
  // `origin_m` is the point that the source's sound comes from, in the source's frame.
  [[nodiscard]] Sighting sight(const Motion& source, const Vec3& origin_m, const Motion& listener) const REALTIME;
  [[nodiscard]] bool still() const REALTIME { return track_.still(); }
  // Increases when the listener jumps, and when the air changes.
  [[nodiscard]] std::uint32_t jumps() const REALTIME { return track_.jumps() + airs_; }
  [[nodiscard]] const modal::AirAbsorption& absorption() const REALTIME { return absorption_; }
  [[nodiscard]] double sound_speed_m_s() const REALTIME { return sound_speed_m_s_; }

 private:
  PoseTrack track_;
  Motion begin_, end_;
  modal::AirAbsorption absorption_;
  double sound_speed_m_s_ = 343.2;
  std::uint32_t airs_ = 0;
  bool on_ = false, travel_time_ = false;
};

}  // namespace ringdown::synth
