// One bank ringing at one sample rate in one material: the mode states, and what advances them.
//
// The worker builds a voice and gives it to the mixer; from then on only the audio thread touches it, until the mixer
// hands it back to be freed. Modes at or above Nyquist, and over-damped ones, are left out when it is built.
//
// A chunk of frames is rendered in one of two ways. render() adds samples, and a chunk may be cut where something
// happens. render_together() adds moments (moments.h) for all modes that decay slowly enough, which is less work when
// many modes sound; strikes within the chunk then ring aside (strike_aside(), render_aside()) until it is over.
#pragma once

#include "engine/base/realtime.h"
#include "engine/modal/material_scale.h"
#include "engine/modal/strike_map.h"
#include "engine/synth/mode_kernel.h"
#include "engine/synth/moments.h"
#include "protocol/event.h"

#include <cstdint>
#include <memory>
#include <new>
#include <vector>

namespace ringdown::synth {

// Output samples per unit of modal acceleration [kg^1/2 m/s^2]: the uniform part of the radiation factor
// G_n = 2 pi f_n kOutputScale. Chosen so that a strike of 0.1 N s on a 1 kg object peaks near -12 dB of full scale.
inline constexpr double kOutputScale = 1e-4;

class Voice {
 public:
  // [worker]
  Voice(std::shared_ptr<const modal::StrikeMap> map, const modal::MaterialScale& material, double sample_rate_hz);

  // Adds a strike (EventType::strike or strike_vertex) at the current frame; it sounds from the next rendered one.
  // False when the vertex does not exist. [audio]
  bool strike(const protocol::Event& event) RINGDOWN_REALTIME { return excite(event, row(z_im), true); }

  // Takes over what rings in `other`, a voice of the same bank: phase and amplitude continue, pitch and decay are
  // those of this voice from here on. [audio]
  void take_over(const Voice& other) RINGDOWN_REALTIME;

  // Lets what rings now fade out linearly within kFadeFrames; later strikes ring in full. [audio]
  void fade_out() RINGDOWN_REALTIME;

  // Ends everything at once, with the click that this makes if it rings. [audio]
  void silence() RINGDOWN_REALTIME;

  // Says how long the coming chunks are, so that what depends on it is found once. [audio]
  void prepare(std::size_t frames) RINGDOWN_REALTIME;

  // Adds `frames` <= kChunkFrames samples to `out` and moves on. Modes whose amplitude falls below `floor` rest until
  // the next strike. A state that is no longer a number, or absurdly loud, silences the voice: it is not added, and
  // `false` reports it. [audio]
  bool render(double* out, std::size_t frames, double floor) RINGDOWN_REALTIME;

  // The same, by moments where that is possible. `out` gets the rest: nothing unless has_rest() said so before. [audio]
  bool render_together(std::span<const MomentTarget> targets, double* out, std::size_t frames,
                       double floor) RINGDOWN_REALTIME;
  [[nodiscard]] bool has_rest() const RINGDOWN_REALTIME { return fast_.count + fade_left_ > 0; }

  // A strike in the middle of a chunk that render_together() has done; render_aside() adds what it sounds from there
  // on, and join() at the end of the chunk puts it to the rest. [audio]
  bool strike_aside(const protocol::Event& event) RINGDOWN_REALTIME { return excite(event, row(aside_im), false); }
  bool render_aside(double* out, std::size_t frames) RINGDOWN_REALTIME;
  void join() RINGDOWN_REALTIME;

  // False once everything has died away below the floor; rendering would then add nothing. [audio]
  [[nodiscard]] bool ringing() const RINGDOWN_REALTIME { return slow_.count + fast_.count + fade_left_ > 0; }

  // Modes that this sample rate and material can play; how many sound; how many of these take moments.
  [[nodiscard]] std::size_t playable_modes() const RINGDOWN_REALTIME { return mode_of_.size(); }
  [[nodiscard]] std::size_t sounding_modes() const RINGDOWN_REALTIME;
  [[nodiscard]] std::size_t sounding_slow_modes() const RINGDOWN_REALTIME { return kModePadding * slow_.count; }
  [[nodiscard]] const modal::Bank& bank() const RINGDOWN_REALTIME { return map_->bank(); }

  Voice* next = nullptr;  // for the mixer's lists, which must not allocate

  static constexpr std::size_t kFadeFrames = 512;

 private:
  static constexpr std::align_val_t kAlignment{64};  // what the kernels' aligned loads need, at any vector size
  struct AlignedDelete {
    void operator()(void* block) const { ::operator delete[](block, kAlignment); }
  };
  template <class T>
  using Aligned = std::unique_ptr<T[], AlignedDelete>;
  template <class T>
  static Aligned<T> zeros(std::size_t count);
  enum Row {
    z_re,
    z_im,
    aside_re,
    aside_im,
    fade_re,
    fade_im,
    pole_re,
    pole_im,
    full_re,
    full_im,
    rest_re,
    rest_im,
    kRows
  };

  void add_mode(std::uint32_t mode, const modal::DampedMode& damped, std::complex<double> s);
  [[nodiscard]] double* row(Row which) const RINGDOWN_REALTIME { return states_.get() + which * padded_; }
  [[nodiscard]] ModeArrays modes(Row re, Row im, std::size_t frames) const RINGDOWN_REALTIME;
  bool excite(const protocol::Event& event, double* im, bool wake) RINGDOWN_REALTIME;
  double render_fade(double* out, std::size_t frames) RINGDOWN_REALTIME;
  bool keep_if_sane(double energy) RINGDOWN_REALTIME;
  void wake_all() RINGDOWN_REALTIME;
  void clear_row(Row which) RINGDOWN_REALTIME;

  std::shared_ptr<const modal::StrikeMap> map_;
  std::vector<std::uint32_t>
      mode_of_;  // playable mode i is mode mode_of_[i] of the bank; by frequency, slow ones first
  std::vector<std::uint32_t> column_of_;  // where its states stand: the fast ones begin with a group of their own
  std::vector<std::int32_t> place_of_;    // column of a mode of the bank; -1 where it is not playable
  std::vector<double> weight_;            // output per modal velocity: G_n, the bank's gain, the density scale
  std::vector<double> frequency_hz_;
  std::vector<double> excitation_;  // scratch of a strike, one per mode of the bank
  std::size_t padded_ = 0;          // columns, a multiple of kModePadding
  std::size_t slow_modes_ = 0;      // that take moments: the first columns
  std::size_t rest_frames_ = 0;     // whose advance stands in rest_re and rest_im
  Aligned<double> states_;          // kRows x padded_
  Aligned<float> strides_;          // 2 x padded_: p^kRun
  Aligned<float> runs_;             // padded_ x 2 kRun
  Aligned<float> moment_weights_;   // padded_ x 2 kMoments
  std::vector<std::uint16_t> band_;
  std::vector<std::uint32_t> groups_, aside_groups_, fade_groups_;  // the lists
  ActiveGroups slow_, fast_;                                        // in groups_
  std::size_t fade_left_ = 0;
};

}  // namespace ringdown::synth
