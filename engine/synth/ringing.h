// The states of a table's modes, and what moves them on and makes them sound.
//
// A chunk of frames is rendered in one of two ways. render() adds samples, and a chunk may be cut where something
// happens. render_together() adds moments (moments.h) for all modes that decay slowly enough, which is less work when
// many modes sound; strikes within the chunk then ring aside (add_aside(), render_aside()) until it is over.
//
// Groups that take moments can be hidden (hearing.h): survey() tells what there is, listen() what of it is to be
// computed from the next rendered frames on; what comes or goes does so over these frames. A hidden group keeps its
// states as they were and knows since when, so that it is moved on in one jump, exactly, when it is wanted again. A
// strike is added to it, and brings it back if that makes it loud enough.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/aligned_array.h"
#include "engine/synth/drive_kernel.h"
#include "engine/synth/mode_table.h"
#include "engine/synth/mode_watch.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace ringdown::synth {

class Ringing {
 public:
  static constexpr std::size_t kFadeFrames = 512;

  // Silent. The table outlives it. [worker]
  explicit Ringing(const ModeTable& table);

  // Adds a strike's amplitudes (ModeTable::strike), times `gain`, at the current frame; they sound from the next
  // rendered one. [audio]
  void add(const double* amplitudes, double gain) RINGDOWN_REALTIME;

  // Adds what rings in `other`, of the same table, times `gain`. [audio]
  void add(Ringing& other, double gain) RINGDOWN_REALTIME;

  // Takes from `other`, of the same bank, what rings of its modes that are in this table too: phase and amplitude
  // continue, pitch, decay and sample rate are those of this table from here on. True when modes that are not in it
  // still ring in `other`. [audio]
  bool take_over(Ringing& other) RINGDOWN_REALTIME;

  // Lets what rings now fade out linearly within so many frames, at least kFadeFrames; later strikes ring in full.
  // [audio]
  void fade_out(std::size_t frames = kFadeFrames) RINGDOWN_REALTIME;

  // Ends everything at once, with the click that this makes if it rings. [audio]
  void silence() RINGDOWN_REALTIME;

  // Adds `frames` <= kChunkFrames samples to `out` and moves on. Modes whose amplitude falls below `floor` rest until
  // the next strike. A state that is no longer a number, or absurdly loud, silences all: it is not added, and `false`
  // reports it. [audio]
  bool render(double* out, std::size_t frames, double floor) RINGDOWN_REALTIME;

  // The same, by moments where that is possible. `out` gets the rest: nothing unless has_rest() said so before. [audio]
  bool render_together(std::span<const MomentTarget> targets, double* out, std::size_t frames,
                       double floor) RINGDOWN_REALTIME;
  [[nodiscard]] bool has_rest() const RINGDOWN_REALTIME { return fast_.count + fade_left_ > 0; }

  // A strike in the middle of a chunk that render_together() has done, `left` frames before its end; render_aside()
  // adds what it sounds from there on, and join() at the end of the chunk puts it to the rest. [audio]
  void add_aside(const double* amplitudes, double gain, std::size_t left) RINGDOWN_REALTIME;
  bool render_aside(double* out, std::size_t frames) RINGDOWN_REALTIME;
  void join() RINGDOWN_REALTIME;
  // The same under forces: what is aside moves on sample by sample. [audio]
  bool drive_aside(std::span<const Force> forces, double* out, std::size_t frames) RINGDOWN_REALTIME;

  // Notes all groups that sound or are hidden; levels are those of the states plus `shift`. What is hidden and has
  // fallen below `floor` rests from now on. [audio]
  void survey(Hearing& hearing, Level shift, double floor) RINGDOWN_REALTIME;
  // Hides and brings back by what a survey has found; at most so many modes come back, and `most_coming` is lessened by
  // them. The cut lives until the next call. [audio]
  void listen(const Cut& cut, Level shift, std::size_t& most_coming) RINGDOWN_REALTIME;
  // Has only strikes judged by the cut. [audio]
  void attend(const Cut& cut, Level shift) RINGDOWN_REALTIME;
  // Whether it has yet to listen to this one; whether some is hidden only because it was missed.
  [[nodiscard]] bool ignores(const Cut& cut) const RINGDOWN_REALTIME { return cut_number_ != cut.number; }
  [[nodiscard]] bool missed() const RINGDOWN_REALTIME { return cut_number_ == kNoCut; }
  // In place of rendering `frames`, when there is no time: hides all, at once; what fades goes on fading, unheard.
  // [audio]
  void miss(std::size_t frames) RINGDOWN_REALTIME;
  // Lets all that is hidden sound. [audio]
  void reveal() RINGDOWN_REALTIME;

  // Moves the states on without a sound, however far; not what fades. [audio]
  void skip(Frame frames) RINGDOWN_REALTIME;
  // Keeps the states as they are, but renders none of them until wake(). [audio]
  void rest() RINGDOWN_REALTIME;
  void wake() RINGDOWN_REALTIME;

  // False once everything has died away below the floor; rendering would then add nothing. [audio]
  [[nodiscard]] bool ringing() const RINGDOWN_REALTIME {
    return slow_.count + fast_.count + fade_left_ + hidden_modes() > 0;
  }
  [[nodiscard]] bool fading() const RINGDOWN_REALTIME { return fade_left_ > 0; }

  // What no sample of what rings exceeds: the sum of its modes' amplitudes, hidden ones and what fades among them. The
  // second of states that have rested for so many frames, the modes of a group taken to decay as the slowest of them.
  // Nothing moves on. [audio]
  [[nodiscard]] double reach() const RINGDOWN_REALTIME;
  [[nodiscard]] double reach_at_rest(Frame frames) const RINGDOWN_REALTIME;

  // The same of each mode, times `gain`, added to where it stands in the bank's order; each mode decays as it does.
  // [audio]
  void add_amplitudes(double gain, ModeWatch::Place& to) const RINGDOWN_REALTIME;
  void add_amplitudes_at_rest(double gain, Frame frames, ModeWatch::Place& to) const RINGDOWN_REALTIME;

  // How many modes sound; how many of these take moments.
  [[nodiscard]] std::size_t sounding_modes() const RINGDOWN_REALTIME;
  [[nodiscard]] std::size_t hidden_modes() const RINGDOWN_REALTIME {
    return kModePadding * (hidden_.size() + leaving_.size() + coming_.size());
  }
  [[nodiscard]] std::size_t sounding_slow_modes() const RINGDOWN_REALTIME { return kModePadding * slow_.count; }

  // |z|^2 of a mode above which something is wrong: 240 dB over full scale. Also catches what is not a number.
  static constexpr double kAbsurdEnergy = 1e24;

 private:
  // Some slow groups.
  class Groups {
   public:
    explicit Groups(std::size_t most) : list_(most) {}
    [[nodiscard]] std::size_t size() const RINGDOWN_REALTIME { return count_; }
    [[nodiscard]] std::uint32_t operator[](std::size_t i) const RINGDOWN_REALTIME { return list_.data()[i]; }
    void put(std::uint32_t group) RINGDOWN_REALTIME { list_.data()[count_++] = group; }
    void clear() RINGDOWN_REALTIME { count_ = 0; }
    // Keeps those of which `wanted` says so.
    template <class Wanted>
    void keep(const Wanted& wanted) RINGDOWN_REALTIME {
      std::size_t kept = 0;
      for (std::size_t i = 0; i < count_; ++i) {
        const std::uint32_t group = list_.data()[i];
        if (wanted(group)) list_.data()[kept++] = group;
      }
      count_ = kept;
    }
    ActiveGroups active() RINGDOWN_REALTIME { return {list_.data(), count_}; }

   private:
    std::vector<std::uint32_t> list_;
    std::size_t count_ = 0;
  };
  enum Row { z_re, z_im, aside_re, aside_im, fade_re, fade_im, kRows };

  [[nodiscard]] double* row(Row which) const RINGDOWN_REALTIME { return states_.get() + which * table_.columns(); }
  [[nodiscard]] ModeArrays modes(Row re, Row im, std::size_t frames) const RINGDOWN_REALTIME {
    return table_.modes(row(re), row(im), frames);
  }
  void add_group(std::uint32_t group, double gain, double frames, ModeWatch::Place& to) const RINGDOWN_REALTIME;
  [[nodiscard]] double amplitudes_of(std::uint32_t group) const RINGDOWN_REALTIME;  // their sum
  using Energies = std::array<double, kModePadding>;                                // |z|^2 of a group's modes
  [[nodiscard]] Energies energies_of(std::uint32_t group) const RINGDOWN_REALTIME;
  [[nodiscard]] bool passes(const Energies& energies, std::uint32_t group, Level shift) const RINGDOWN_REALTIME;
  [[nodiscard]] bool wakes(const double* amplitudes, double gain, std::uint32_t group) const RINGDOWN_REALTIME;
  [[nodiscard]] Level fallen(std::uint32_t group) const RINGDOWN_REALTIME;
  void sound(std::uint32_t group) RINGDOWN_REALTIME { slow_.list[slow_.count++] = group; }
  void hide(std::uint32_t group) RINGDOWN_REALTIME;
  void skip_group(Row re, Row im, std::uint32_t group, std::uint64_t frames) RINGDOWN_REALTIME;
  void add_selectively(const Ringing& other, double gain) RINGDOWN_REALTIME;
  void catch_up(std::uint32_t group) RINGDOWN_REALTIME;
  void settle() RINGDOWN_REALTIME;
  void mark() RINGDOWN_REALTIME;
  void add_listening(const double* amplitudes, double gain) RINGDOWN_REALTIME;
  void add_quietly(std::uint32_t group, const double* amplitudes, double gain, std::size_t left) RINGDOWN_REALTIME;
  bool render_changes(double* out, std::size_t frames) RINGDOWN_REALTIME;
  bool add_changes(std::size_t frames, std::span<const MomentTarget> targets) RINGDOWN_REALTIME;
  void finish_changes(std::size_t frames) RINGDOWN_REALTIME;
  [[nodiscard]] bool selective() const RINGDOWN_REALTIME { return cut_ || hidden_modes() > 0; }
  bool render_fade(double* out, std::size_t frames) RINGDOWN_REALTIME;
  bool keep_if(bool sane) RINGDOWN_REALTIME;
  void clear_row(Row which) RINGDOWN_REALTIME;

  const ModeTable& table_;
  AlignedArray<double> states_;                                     // kRows x columns
  std::vector<std::uint32_t> groups_, aside_groups_, fade_groups_;  // the lists
  ActiveGroups slow_, fast_;                                        // in groups_
  std::size_t fade_left_ = 0, fade_frames_ = kFadeFrames;

  const Cut* cut_ = nullptr;  // null: everything sounds
  Level shift_ = 0;
  std::uint32_t cut_number_ = 0;
  static constexpr std::uint32_t kNoCut = ~0u;
  Groups hidden_, leaving_, coming_;  // the latter two for the next rendered frames
  std::size_t aside_count_ = 0;       // in aside_groups_
  std::vector<Frame> hidden_since_;   // of each hidden or coming group, by clock_
  enum class State : std::uint8_t { resting, sounding, hidden, aside };
  std::vector<State> state_;  // scratch of a strike
  Frame clock_ = 0;           // frames rendered
};

}  // namespace ringdown::synth
