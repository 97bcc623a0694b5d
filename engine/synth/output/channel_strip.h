// An object's gain, pan and bus: routes its sound, one channel, to the mixer's channels. Gains move in straight lines
// that do not depend on how time is cut into chunks. An object that a listener hears from a place (placement.h) is
// panned by that place instead, in one straight line for each cell (chunk.h). [audio]
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/vec3.h"
#include "engine/synth/modes/chunk.h"
#include "engine/synth/events/ramp.h"

#include <array>
#include <cstddef>
#include <span>

namespace ringdown::synth {

class ChannelStrip {
 public:
  ChannelStrip() REALTIME;

  // The bytes at its beginning that every chunk reads: the ramps up to the first of encoded_.
  static constexpr std::size_t kOftenRead = 192;

  // Moves the gain or the pan (-1 left ... +1 right, equal power) to a value within `length` frames from frame `at` on.
  void set_gain(double gain, Frame at, Frame length) REALTIME;
  // In ambisonic channels a pan is a direction between two loudspeakers at 30 degrees from the front.
  void set_pan(double pan, Frame at, Frame length) REALTIME;
  // Silences the object at all outputs, or restores the gain that was set last, including one set in the meantime.
  void set_silent(bool silent, Frame at, Frame length) REALTIME;
  // Sets the channel of a bus that gets the object's sound at its gain, in addition to the mix. kNoBus: none.
  void set_bus(std::size_t channel) REALTIME { bus_ = channel; }
  void reset() REALTIME { *this = {}; }
  // Adapts to a new sample rate: ramps end `ratio` times as many frames after `now`. [worker]
  void rescale(Frame now, double ratio);

  // The place from which an object is heard: its level, and the direction towards it in the listener's frame
  // (listening.h), shorter than 1 if the sound surrounds the listener.
  struct Place {
    Vec3 toward{1, 0, 0};
    double level = 1;
    friend bool operator==(const Place&, const Place&) = default;
  };
  struct Span {
    Frame begin = 0, end = 0;
  };
  // In the frames of a span, moves the object from its present place towards `to`, by this share of the way. A share
  // above 1 means that it was not heard before; it then begins at `from`.
  void place(const Place& from, const Place& to, Span span, double share) REALTIME;
  // Returns whether place() has already set the line that ends at frame `end`, with the gain of that frame.
  [[nodiscard]] bool placed_until(Frame end) const REALTIME;
  // Moves the object back to its own pan, in the way of place().
  void place_nowhere(Span span, double share) REALTIME;
  void stand(Frame now) REALTIME;  // keeps the object in place from now on
  void unplace() REALTIME { placed_ = false; }
  // Returns the gain due to distance; 1 without a place.
  [[nodiscard]] double place_level() const REALTIME { return placed_ ? place_.level : 1; }

  [[nodiscard]] bool still_at(Frame frame) const REALTIME {
    return gain_.still_at(frame) && left_.still_at(frame) && right_.still_at(frame) && encoded_.front().still_at(frame);
  }
  [[nodiscard]] double gain_at(Frame frame) const REALTIME { return gain_.at(frame); }
  [[nodiscard]] double final_gain() const REALTIME { return gain_.to; }
  [[nodiscard]] double max_gain() const REALTIME;  // largest |gain| of the present or last ramp
  [[nodiscard]] std::size_t bus() const REALTIME { return bus_; }
  [[nodiscard]] bool heard(ChannelSet wanted) const REALTIME;

  // Returns the final gains of left, right, bus (0 without one), and ambisonic channels.
  static constexpr std::size_t kFirstField = 3, kOutputs = kFirstField + kMaxAmbisonicChannels;
  using Shares = std::array<double, kOutputs>;
  [[nodiscard]] Shares shares() const REALTIME;

  // Adds frames begin ... end - 1 of the chunk from `mono`, whose index is the frame in the chunk.
  void add_samples(const double* mono, std::size_t begin, std::size_t end, const Chunk& chunk,
                   ChannelSums& sums) const REALTIME;
  // Returns the sums, except those of ambisonic channels, to which moments are added while gain and pan are constant:
  // the part of `targets` that it filled in.
  static constexpr std::size_t kMaxTargets = 3;
  std::span<const MomentTarget> moment_targets(const Chunk& chunk, ChannelSums& sums,
                                               std::array<MomentTarget, kMaxTargets>& targets) const REALTIME;
  // Used instead if ambisonic channels are wanted: adds to all channels everything that was added since
  // FieldSums::begin_object().
  void add_to_field(const Chunk& chunk, FieldSums& field) const REALTIME;

 private:
  void set_direction(Vec3 towards, Frame at, Frame length) REALTIME;
  static constexpr double kCentre = 0.70710678118654752;  // equal power: cos 45 degrees
  // Returns the gains at left, right, bus and field.
  [[nodiscard]] Shares shares_at(const Place& place, Frame frame) const REALTIME;
  [[nodiscard]] Shares shares_at(Frame frame) const REALTIME;
  [[nodiscard]] Shares line_at(Frame frame) const REALTIME;
  void go(const Shares& from, const Shares& to, Span span, double share) REALTIME;
  // Returns the gain in a chunk at left, right, or the bus.
  [[nodiscard]] GainLine gain_line(std::size_t output, Frame chunk_begin) const REALTIME;

  bool placed_ = false;
  bool silent_ = false;
  double set_gain_ = 1;  // last gain set; gain_ moves to 0 instead while the object is silent
  std::size_t bus_ = kNoBus;
  Ramp gain_{1, 1}, left_{kCentre, kCentre}, right_{kCentre, kCentre};
  std::array<Ramp, kMaxAmbisonicChannels> encoded_;
  std::array<float, kMaxAmbisonicChannels> encoded_to_;  // final gains of encoded_
  Shares from_{}, to_{};                                 // gains at the ends of line_, while placed_
  Span line_;
  Place place_;            // the last place
  double place_gain_ = 0;  // the gain for which to_ was computed; NaN: to_ is not final
};

}  // namespace ringdown::synth
