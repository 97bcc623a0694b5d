// One bank ringing at one sample rate in one material: the mode states, and what advances them.
//
// The worker builds a voice and gives it to the mixer; from then on only the audio thread touches it, until the mixer
// hands it back to be freed. Modes at or above Nyquist, and over-damped ones, are left out when it is built.
#pragma once

#include "engine/base/realtime.h"
#include "engine/modal/material_scale.h"
#include "engine/modal/strike_map.h"
#include "engine/synth/mode_kernel.h"
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
  bool strike(const protocol::Event& event) RINGDOWN_REALTIME;

  // Takes over what rings in `other`, a voice of the same bank: phase and amplitude continue, pitch and decay are
  // those of this voice from here on. [audio]
  void take_over(const Voice& other) RINGDOWN_REALTIME;

  // Lets what rings now fade out linearly within kFadeFrames; later strikes ring in full. [audio]
  void fade_out() RINGDOWN_REALTIME;

  // Ends everything at once, with the click that this makes if it rings. [audio]
  void silence() RINGDOWN_REALTIME;

  // Adds `frames` <= kChunkFrames samples to `out` and moves on. A state that is no longer a number, or absurdly loud,
  // silences the voice: nothing is added, and `false` reports it. [audio]
  bool render(double* out, std::size_t frames) RINGDOWN_REALTIME;

  // False once everything has died away below the floor; rendering would then add nothing. [audio]
  [[nodiscard]] bool ringing() const RINGDOWN_REALTIME { return ringing_ || fade_left_ > 0; }

  // Modes that this sample rate and material can play.
  [[nodiscard]] std::size_t playable_modes() const RINGDOWN_REALTIME { return mode_of_.size(); }
  [[nodiscard]] const modal::Bank& bank() const RINGDOWN_REALTIME { return map_->bank(); }

  Voice* next = nullptr;  // for the mixer's lists, which must not allocate

  static constexpr std::size_t kFadeFrames = 512;

 private:
  static constexpr std::align_val_t kAlignment{64};  // what the kernel's aligned loads need, at any vector size
  struct AlignedDelete {
    void operator()(double* block) const { ::operator delete[](block, kAlignment); }
  };
  enum Row { z_re, z_im, fade_re, fade_im, pole_re, pole_im, chunk_re, chunk_im, kRows };
  [[nodiscard]] double* row(Row which) const RINGDOWN_REALTIME { return states_.get() + which * padded_; }
  [[nodiscard]] ModeArrays modes(Row re, Row im) const RINGDOWN_REALTIME;
  double render_fade(double* out, std::size_t frames) RINGDOWN_REALTIME;

  std::shared_ptr<const modal::StrikeMap> map_;
  std::vector<std::uint32_t> mode_of_;  // playable mode i is mode mode_of_[i] of the bank
  std::vector<std::int32_t> place_of_;  // and back; -1 where the bank's mode is not playable
  std::vector<double> weight_;          // output per modal velocity: G_n, the bank's gain, the density scale
  std::vector<double> frequency_hz_;
  std::vector<double> excitation_;                   // scratch of a strike, one per mode of the bank
  std::size_t padded_ = 0;                           // playable modes, rounded up to kModePadding
  std::unique_ptr<double[], AlignedDelete> states_;  // kRows x padded_
  std::size_t fade_left_ = 0;
  bool ringing_ = false;
};

}  // namespace ringdown::synth
