// What a voice should do, mode by mode in long double: a strike adds to a state, time multiplies it with exp(s t).
// Shares no code with engine/synth.
#pragma once

#include "tests/synth/player.h"

#include <complex>
#include <cstddef>
#include <limits>
#include <vector>

namespace ringdown::synth::test {

using Exact = std::complex<long double>;

// The floor of a mixer whose modes never rest.
inline constexpr double kNever = std::numeric_limits<double>::infinity();

class ExactVoice {
 public:
  ExactVoice(Map map, double rate_hz, const modal::MaterialScale& material = {});

  // At the event's frame, which is not before any earlier one. Returns the sum over modes of what |z| it adds. Modes
  // below `floor` may have been put to rest before: from then on they differ by what was lost, which loudness() counts.
  double strike(const Event& event, double floor = 0);

  // The states of `other`, at these pitches and decays from `now` on.
  void take_over(const ExactVoice& other, Frame now);

  // Whether a mode plays here that does not in `other`.
  [[nodiscard]] bool has_more_than(const ExactVoice& other) const;

  // All states become zero.
  void silence();

  // Sum over modes of what |z| can be at a frame at or after the last strike: no sample is larger from there on.
  [[nodiscard]] double loudness(Frame when) const;

  // What it sounds in frames [first, first + count), all at or after the last strike.
  [[nodiscard]] Samples samples(Frame first, std::size_t count) const;

  [[nodiscard]] const Map& map() const { return map_; }

 private:
  struct ExactMode {
    bool plays = false;
    double frequency_hz = 0;
    Exact s;             // per frame
    long double weight;  // output per modal velocity
    Exact z;             // at frame at_
    double size = 0;     // |z| at frame at_
    double lost = 0;     // the most that resting may have taken from z, or, by taking its opposite, added to it
  };
  void advance(Frame to);

  Map map_;
  std::vector<ExactMode> modes_;  // of the bank
  Frame at_ = 0;
};

}  // namespace ringdown::synth::test
