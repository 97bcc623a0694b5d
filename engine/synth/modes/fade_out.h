// Lets states fade out: they ring on under a gain that falls to 0, and take no more strikes.
// [audio, after construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/modes/probes.h"
#include "engine/synth/modes/state_array.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ringdown::synth {

// Duration and shape of a fade: the gain falls in a straight line, or exponentially by `nepers` and then in a straight
// line within the last FadeOut::kMinFrames. An exponential fade shorter than that is a straight line, and
// clicks.
struct Fading {
  std::size_t frames = 0;
  double nepers = 0;  // 0: a straight line
};

class FadeOut {
 public:
  static constexpr std::size_t kMinFrames = 512;  // a shorter fade would click

  explicit FadeOut(const ModeTable& table);  // [worker]

  // Takes what `from` holds, leaves zeros there, and lets it fade, within at least kMinFrames if by a straight line.
  // The rest of a fade that runs already joins the new one at its present level.
  void begin(StateArray& from, const Fading& fade) REALTIME;

  // Goes on with a fade of another table of the same bank (StateArray::move_from). True when some of it is left there.
  // `change` is there when the tables are of the same object before and after it changed (StateArray::move_from): then
  // nothing is left.
  bool move_from(FadeOut& other, const modal::ModeTransfer* change = nullptr) REALTIME;

  // Adds the next `frames` <= kChunkFrames samples to `out`. False when a state is absurd: nothing was added. Runs only
  // while running().
  bool render(double* out, std::size_t frames) REALTIME;
  // Adds what probes feel of the next `frames`.
  void feel(const Probes& probes, std::size_t frames) REALTIME;
  // Moves on as render() does, without a sound.
  void skip(std::size_t frames) REALTIME;
  void clear() REALTIME;

  [[nodiscard]] bool running() const REALTIME { return left_ > 0; }
  // The present gain of states().
  [[nodiscard]] double level() const REALTIME;
  void hear_by(const Hearing* hearing) REALTIME { states_.hear_by(hearing); }
  [[nodiscard]] const StateArray& states() const REALTIME { return states_; }

 private:
  // Adds the samples of the next `frames` under the falling gain to `out`.
  void add_faded(const double* samples, double* out, std::size_t frames) const REALTIME;

  StateArray states_;
  std::vector<std::uint32_t> all_groups_;
  std::size_t left_ = 0, frames_ = kMinFrames;
  double nepers_ = 0;
};

}  // namespace ringdown::synth
