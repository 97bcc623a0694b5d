// The modes of one table as they ring: their states, which groups of them sound, and what moves them on.
//
// A chunk of frames is rendered in one of two ways. render() adds samples by tables (mode_kernel.h), and a chunk may be
// cut where something happens. render_moments() adds moments (moments.h) for all modes that decay slowly enough, which
// is less work when many modes sound; strikes within the chunk are then late strikes, which ring by tables beside the
// moments until merge_late() ends the chunk.
//
// When time is short, groups below a threshold are muted (muting.h): set_threshold() says which, and apply_threshold()
// mutes and brings back. A strike on a muted group is added to it, and brings it back if that makes it loud enough.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/modes/coupled_modes.h"
#include "engine/synth/modes/fade_out.h"
#include "engine/synth/modes/late_strikes.h"
#include "engine/synth/modes/level_histogram.h"
#include "engine/synth/modes/mode_gains.h"
#include "engine/synth/modes/mode_table.h"
#include "engine/synth/modes/mode_watch.h"
#include "engine/synth/modes/muting.h"
#include "engine/synth/modes/probes.h"
#include "engine/synth/modes/state_array.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace ringdown::synth {

class ModeStates {
  friend class VoiceFetch;
  friend class TouchedStates;

 public:
  // Silent. The table outlives the states. [worker]
  explicit ModeStates(const ModeTable& table);

  // Everything from here on: [audio]

  // Adds a strike's amplitudes (ModeTable::strike), times `gain`, at the current frame; they sound from the next
  // rendered frame on. With `each`, every mode is multiplied by a gain of its own as well.
  void add(BlowAmplitudes blow, double gain, const ModeFactors* each = nullptr) REALTIME;
  // Returns the share of a strike's amplitudes that may be added (blow_limit.h); 1 for all but thin objects struck very
  // hard.
  [[nodiscard]] double blow_limit(const double* amplitudes) const REALTIME;
  // Adds what rings in `other`, of the same table, times `gain` and `each`. What fades out is left alone.
  void add(ModeStates& other, double gain, const ModeFactors* each = nullptr) REALTIME;
  // Takes over from `other`, of the same bank, the modes that are in this table too: phase and amplitude continue;
  // pitch, decay and sample rate are this table's from here on. True when other modes still ring in `other`.
  // If `other` is of the same object before it changed, `change` says what becomes of each mode.
  bool take_over(ModeStates& other, const modal::ModeTransfer* change = nullptr) REALTIME;

  // Lets what rings now fade out (FadeOut::begin); later strikes ring in full.
  void fade_out(const Fading& fade = {}) REALTIME;
  // Ends everything at once, with the click that this makes if it rings.
  void silence() REALTIME;

  // Adds `frames` <= kChunkFrames samples to `out` and moves on. A group whose modes have all fallen below the
  // amplitude `floor` rests until the next strike. False when a state is absurd (kAbsurdEnergy): nothing of it was
  // added, and all states have been silenced.
  bool render(double* out, std::size_t frames, double floor) REALTIME;
  // Renders as render() does, with moments for slow modes; `out` gets the rest, which is nothing unless needs_samples()
  // said so before.
  bool render_moments(std::span<const MomentTarget> targets, double* out, std::size_t frames, double floor) REALTIME;
  [[nodiscard]] bool needs_samples() const REALTIME {
    return fast_.count > 0 || fade_.running() || coupling.possible();
  }

  // Its modes that exchange energy, if its bank has any.
  Coupling coupling;

  // Places of the surface that all functions which render feel, too.
  Probes probes;

  // How the modes are heard, which changes nothing of what they do: by gains of their own, and in a time that runs
  // `rate` times as fast, which bends by `bend` (Hearing). hear() is called before every function that renders, with
  // the frames from the last gains.advance() on; null ends all that.
  ModeGains gains;
  struct HeardTime {
    std::size_t offset = 0;
    double rate = 1, bend = 0;
  };
  void hear(const HeardTime* time) REALTIME;
  // After hear() with a time, for one call of `frames`: what comes out of a tube goes from one gain to another in a
  // straight line.
  void hear_tube(double from, double to, std::size_t frames) REALTIME;

  // A strike in the middle of a chunk that render_moments() has done, `frames_left` before its end. render_late() adds
  // what it sounds from there on (LateStrikes), driven sample by sample where there are `forces`, if only an empty
  // list; merge_late() ends the chunk.
  void add_late(BlowAmplitudes blow, double gain, std::size_t frames_left, const ModeFactors* each = nullptr) REALTIME;
  bool render_late(double* out, std::size_t frames, std::optional<std::span<const Force>> forces = {}) REALTIME;
  void merge_late() REALTIME;

  // Groups whose level lies below `threshold` may be muted; kNoThreshold: none may. True when the threshold has risen
  // since it was last applied.
  bool set_threshold(Level threshold) REALTIME {
    threshold_ = threshold;
    return threshold_ > applied_;
  }
  // Mutes what lies below the threshold, by a ramp over the next chunk or `at_once`; brings back what lies well above,
  // at most `allowance` modes, which is lowered by what came back.
  void apply_threshold(std::size_t& allowance, bool at_once) REALTIME;
  // In place of rendering `frames`, when there is no time: mutes all that can be muted, at once.
  void mute_all(std::size_t frames) REALTIME;
  // Counts every group that sounds or is muted, `gain` above the level of its states. Muted groups that have fallen
  // below the amplitude `floor` rest from now on.
  void count_levels(LevelHistogram& histogram, Level gain, double floor) REALTIME;

  // Moves the states on without a sound, however far; not what fades.
  void skip(Frame frames) REALTIME;
  // rest() keeps the states as they are and renders none of them until wake().
  void rest() REALTIME;
  void wake() REALTIME;

  // False once everything has died away below the floor; rendering would then add nothing.
  [[nodiscard]] bool ringing() const REALTIME {
    return slow_.count + fast_.count + muting_.groups() > 0 || fade_.running() || coupling.running();
  }
  struct Counts {
    std::size_t sounding = 0, muted = 0;  // modes
    std::size_t slow = 0;                 // of the sounding ones, those that take moments
    bool fading = false;                  // something fades out (fade_out())
    bool cut_short = false;               // modes above the threshold are muted, because there was no time for them
    // Adds the numbers of modes.
    void add(const Counts& other) REALTIME {
      sounding += other.sounding;
      muted += other.muted;
      slow += other.slow;
    }
  };
  [[nodiscard]] Counts counts() const REALTIME {
    const std::size_t slow = std::min(kModePadding * slow_.count, table_.slow_modes());
    const std::size_t fast = std::min(kModePadding * fast_.count, table_.playable_modes() - table_.slow_modes());
    return {slow + fast, kModePadding * muting_.groups(), kModePadding * slow_.count, fade_.running(), cut_short_};
  }

  // An upper bound of every sample: the sum of the modes' amplitudes, muted and fading ones included. The states
  // have rested for `rested` frames, 0 unless rest() was called; resting modes are taken to decay as the slowest of
  // their group.
  [[nodiscard]] double peak_level(Frame rested) const REALTIME;
  // Adds each mode's amplitude, times `gain`, to where the mode stands in the bank's order. The states have rested as
  // above.
  void add_amplitudes(double gain, Frame rested, ModeWatch::Slot& to) const REALTIME;

 private:
  template <class Add>
  void add_to_groups(const Add& add_to) REALTIME;
  void list(std::uint32_t group) REALTIME;
  void settle() REALTIME;
  void unmute() REALTIME;
  void mark() REALTIME;

  const ModeTable& table_;
  StateArray states_;
  Hearing hearing_;
  AlignedArray<float> tube_gains_;       // 4 x columns: gains and steps, as in Hearing; null: no tube
  std::vector<std::uint32_t> sounding_;  // groups: slow ones from the front, fast ones from slow_groups() on
  ActiveGroups slow_, fast_;             // in sounding_
  FadeOut fade_;
  LateStrikes late_;
  Muting muting_;
  Level threshold_ = kNoThreshold, applied_ = kNoThreshold;
  bool cut_short_ = false;
  enum class Is : std::uint8_t { resting, sounding, muted };
  std::vector<Is> is_;  // what each group does, as mark() found it
};

}  // namespace ringdown::synth
