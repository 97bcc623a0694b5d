// An object's gain, pan and bus: how its sound, one channel, reaches the channels of the mixer. Gains move in straight
// lines that do not depend on how time is cut into chunks. An object that a listener hears from a place (placement.h)
// is panned by that place instead, in one straight line for each cell (chunk.h). [audio]
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/vec3.h"
#include "engine/synth/chunk.h"
#include "engine/synth/ramp.h"

#include <array>
#include <cstddef>
#include <span>

namespace ringdown::synth {

class ChannelStrip {
 public:
  ChannelStrip() RINGDOWN_REALTIME;

  // Moves the gain or the pan (-1 left ... +1 right, equal power) to a value within `length` frames from frame `at` on.
  void set_gain(double gain, Frame at, Frame length) RINGDOWN_REALTIME;
  // To ambisonic channels a pan is a direction between the places of two loudspeakers, 30 degrees from the front.
  void set_pan(double pan, Frame at, Frame length) RINGDOWN_REALTIME;
  // Silences the object at all outputs, or lets it be heard again at the gain that was set last. A gain that is set
  // meanwhile is kept for then.
  void set_silent(bool silent, Frame at, Frame length) RINGDOWN_REALTIME;
  // The channel of a bus that gets the object's sound at its gain, beside the mix; kNoBus: none.
  void set_bus(std::size_t channel) RINGDOWN_REALTIME { bus_ = channel; }
  void reset() RINGDOWN_REALTIME { *this = {}; }
  // Changes the length of a frame: ramps end `ratio` times as many frames after `now`. [worker]
  void rescale(Frame now, double ratio);

  // The place from which an object is heard: the direction towards it, in the listener's frame (listening.h), shorter
  // than 1 where it is all around; and its level.
  struct Place {
    Vec3 toward{1, 0, 0};
    double level = 1;
    friend bool operator==(const Place&, const Place&) = default;
  };
  struct Span {
    Frame begin = 0, end = 0;
  };
  // In the frames of a span it goes from one place to another, from where it is heard from at its begin by a share of
  // the way. A share above 1: it was not heard before, and begins at `from`.
  void place(const Place& from, const Place& to, Span span, double share) RINGDOWN_REALTIME;
  // Returns whether the object is on its way, by place(), to where it should be at the frame `end`, and to its gain.
  [[nodiscard]] bool placed_until(Frame end) const RINGDOWN_REALTIME;
  // The object goes back to its own pan, as by place().
  void place_nowhere(Span span, double share) RINGDOWN_REALTIME;
  void stand(Frame now) RINGDOWN_REALTIME;  // from now on it stays where it is
  void unplace() RINGDOWN_REALTIME { placed_ = false; }
  // By what distance lowers its level; 1 without a place.
  [[nodiscard]] double place_level() const RINGDOWN_REALTIME { return placed_ ? place_.level : 1; }

  [[nodiscard]] bool still_at(Frame frame) const RINGDOWN_REALTIME {
    return gain_.still_at(frame) && left_.still_at(frame) && right_.still_at(frame) && encoded_.back().still_at(frame);
  }
  [[nodiscard]] double gain_at(Frame frame) const RINGDOWN_REALTIME { return gain_.at(frame); }
  [[nodiscard]] double final_gain() const RINGDOWN_REALTIME { return gain_.to; }
  [[nodiscard]] double max_gain() const RINGDOWN_REALTIME;  // the largest |gain| of a ramp that runs, or last ran
  [[nodiscard]] std::size_t bus() const RINGDOWN_REALTIME { return bus_; }
  [[nodiscard]] bool heard(ChannelSet wanted) const RINGDOWN_REALTIME;

  // Final gains to the left, the right, the bus (0 without one), and the ambisonic channels.
  static constexpr std::size_t kFirstField = 3, kOutputs = kFirstField + kMaxAmbisonicChannels;
  using Shares = std::array<double, kOutputs>;
  [[nodiscard]] Shares shares() const RINGDOWN_REALTIME;

  // Adds frames begin ... end - 1 of the chunk, which stand in `mono` from its index `begin` on.
  void add_samples(const double* mono, std::size_t begin, std::size_t end, const Chunk& chunk,
                   ChannelSums& sums) const RINGDOWN_REALTIME;
  // The sums to which moments are added while gain and pan stand still, but for ambisonic channels. Returns the part of
  // `targets` that it filled in.
  static constexpr std::size_t kMaxTargets = 3;
  std::span<const MomentTarget> moment_targets(const Chunk& chunk, ChannelSums& sums,
                                               std::array<MomentTarget, kMaxTargets>& targets) const RINGDOWN_REALTIME;
  // In place of these, where ambisonic channels are wanted: what was added since FieldSums::begin_object() is heard in
  // all channels.
  void add_to_field(const Chunk& chunk, FieldSums& field) const RINGDOWN_REALTIME;

 private:
  void set_direction(Vec3 towards, Frame at, Frame length) RINGDOWN_REALTIME;
  static constexpr double kCentre = 0.70710678118654752;  // equal power: cos 45 degrees
  // Gains at the outputs: left, right, bus and field.
  [[nodiscard]] Shares shares_at(const Place& place, Frame frame) const RINGDOWN_REALTIME;
  [[nodiscard]] Shares shares_at(Frame frame) const RINGDOWN_REALTIME;
  [[nodiscard]] Shares line_at(Frame frame) const RINGDOWN_REALTIME;
  void go(const Shares& from, const Shares& to, Span span, double share) RINGDOWN_REALTIME;
  // In a chunk, at left, right, or the bus.
  [[nodiscard]] GainLine gain_line(std::size_t output, Frame chunk_begin) const RINGDOWN_REALTIME;

  bool placed_ = false;
  Shares from_{}, to_{};  // at the ends of line_, while it is placed
  Span line_;
  Place place_;            // the last one
  double place_gain_ = 0;  // the gain at which to_ is that place's; not a number: to_ is on its way
  Ramp gain_{1, 1}, left_{kCentre, kCentre}, right_{kCentre, kCentre};
  std::array<Ramp, kMaxAmbisonicChannels> encoded_;
  std::array<float, kMaxAmbisonicChannels> encoded_to_;  // where they end
  std::size_t bus_ = kNoBus;
  double set_gain_ = 1;  // as set last; gain_ moves to 0 instead while the object is silent
  bool silent_ = false;
};

}  // namespace ringdown::synth
