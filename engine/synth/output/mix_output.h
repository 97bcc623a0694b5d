// Turns the sums of a chunk into output: writes samples, adds the test tone, limits the mix, and feeds the taps.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/events/event.h"
#include "engine/synth/kernels/block_io.h"
#include "engine/synth/kernels/channel_sums.h"
#include "engine/synth/output/binaural.h"
#include "engine/synth/output/limiter.h"
#include "engine/synth/output/sound_tap.h"
#include "engine/synth/output/test_tone.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace ringdown::synth {

class MixOutput {
 public:
  TestTone test_tone;    // a sine in the mix
  SoundTap sound_tap;    // the mix, for clients that show it
  SoundTap capture_tap;  // the mix, for a sound file

  // Keeps the mix, but not the buses, below a ceiling in dB of full scale (limiter.h); nullopt: samples are unchanged.
  // [worker, while nothing is rendered]
  void limit(std::optional<double> ceiling_db, double sample_rate_hz);
  // Renders the mix for a head's ears from the ambisonic channels; null: stereo. [worker, while nothing is rendered]
  void wear(std::shared_ptr<const HeadFilters> head);
  // Returns the limiter's delay of the mix in frames. [any, but not while limit() runs]
  [[nodiscard]] std::size_t latency_frames() const { return limiter_ ? limiter_->delay_frames() : 0; }

  // All functions below: [audio]

  // Begins a block; the outputs outlive it. If no output takes the mix but a tap is watched, the mix is rendered
  // nevertheless.
  void begin_block(const Outputs& outputs, std::size_t frames) REALTIME;
  [[nodiscard]] ChannelSet wanted() const REALTIME { return outputs_->wanted(); }
  // Returns the channels that objects must be added to in order to produce the wanted channels.
  [[nodiscard]] ChannelSet to_render() const REALTIME;
  // Writes a chunk's sums to frames at ... at + frames - 1 of the block.
  void write(const ChannelSums& sums, std::size_t at, std::size_t frames) REALTIME;
  // Ends the block, whose first frame is `begin`. Returns the largest |sample| of mix and buses, or infinity if a piece
  // of a channel was silenced because a sample of it would not have been finite.
  [[nodiscard]] float end_block(Frame begin, std::size_t frames, double sample_rate_hz) REALTIME;

 private:
  [[nodiscard]] bool tapped() const REALTIME { return sound_tap.watched() || capture_tap.watched(); }
  void write_piece(const ChannelSums& sums, std::size_t at, std::size_t frames) REALTIME;

  std::optional<Limiter> limiter_;
  std::optional<Binaural> binaural_;
  const Outputs* outputs_ = nullptr;                     // outputs of the present block
  Outputs with_spare_;                                   // these outputs and a mix that only taps take
  float mix_peak_ = 0, bus_peak_ = 0, pickup_peak_ = 0;  // largest |sample| written to mix, buses and pickups
  std::vector<float> spare_left_ = std::vector<float>(kMaxSpare), spare_right_ = spare_left_;
};

}  // namespace ringdown::synth
