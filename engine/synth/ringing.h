// The states of a table's modes, and what moves them on and makes them sound.
//
// A chunk of frames is rendered in one of two ways. render() adds samples, and a chunk may be cut where something
// happens. render_together() adds moments (moments.h) for all modes that decay slowly enough, which is less work when
// many modes sound; strikes within the chunk then ring aside (add_aside(), render_aside()) until it is over.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/aligned_array.h"
#include "engine/synth/drive_kernel.h"
#include "engine/synth/mode_table.h"

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
  void add(const Ringing& other, double gain) RINGDOWN_REALTIME;

  // Takes over what rings in `other`, of the same bank: phase and amplitude continue, pitch, decay and sample rate are
  // those of this table from here on. [audio]
  void take_over(const Ringing& other) RINGDOWN_REALTIME;

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

  // A strike in the middle of a chunk that render_together() has done; render_aside() adds what it sounds from there
  // on, and join() at the end of the chunk puts it to the rest. [audio]
  void add_aside(const double* amplitudes, double gain) RINGDOWN_REALTIME;
  bool render_aside(double* out, std::size_t frames) RINGDOWN_REALTIME;
  void join() RINGDOWN_REALTIME;
  // The same under forces: what is aside moves on sample by sample. [audio]
  bool drive_aside(std::span<const Force> forces, double* out, std::size_t frames) RINGDOWN_REALTIME;

  // Moves the states on without a sound, however far; not what fades. [audio]
  void skip(protocol::Frame frames) RINGDOWN_REALTIME;
  // Keeps the states as they are, but renders none of them until wake(). [audio]
  void rest() RINGDOWN_REALTIME { slow_.count = fast_.count = 0; }
  void wake() RINGDOWN_REALTIME;

  // False once everything has died away below the floor; rendering would then add nothing. [audio]
  [[nodiscard]] bool ringing() const RINGDOWN_REALTIME { return slow_.count + fast_.count + fade_left_ > 0; }
  [[nodiscard]] bool fading() const RINGDOWN_REALTIME { return fade_left_ > 0; }

  // How many modes sound; how many of these take moments.
  [[nodiscard]] std::size_t sounding_modes() const RINGDOWN_REALTIME;
  [[nodiscard]] std::size_t sounding_slow_modes() const RINGDOWN_REALTIME { return kModePadding * slow_.count; }

  // The sum of |z|^2 above which something is wrong: 240 dB over full scale. Also catches what is not a number.
  static constexpr double kAbsurdEnergy = 1e24;

 private:
  enum Row { z_re, z_im, aside_re, aside_im, fade_re, fade_im, kRows };

  [[nodiscard]] double* row(Row which) const RINGDOWN_REALTIME { return states_.get() + which * table_.columns(); }
  [[nodiscard]] ModeArrays modes(Row re, Row im, std::size_t frames) const RINGDOWN_REALTIME {
    return table_.modes(row(re), row(im), frames);
  }
  double render_fade(double* out, std::size_t frames) RINGDOWN_REALTIME;
  bool keep_if_sane(double energy) RINGDOWN_REALTIME;
  void clear_row(Row which) RINGDOWN_REALTIME;

  const ModeTable& table_;
  AlignedArray<double> states_;                                     // kRows x columns
  std::vector<std::uint32_t> groups_, aside_groups_, fade_groups_;  // the lists
  ActiveGroups slow_, fast_;                                        // in groups_
  std::size_t fade_left_ = 0, fade_frames_ = kFadeFrames;
};

}  // namespace ringdown::synth
