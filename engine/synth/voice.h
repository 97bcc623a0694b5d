// One bank ringing at one sample rate in one material, for one object.
//
// The worker builds a voice and gives it to the mixer; from then on only the audio thread touches it, until the mixer
// hands it back to be freed.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/event.h"
#include "engine/synth/mode_table.h"
#include "engine/synth/ringing.h"

#include <memory>
#include <optional>
#include <vector>

namespace ringdown::synth {

class Voice : public Ringing {
 public:
  // Of a table that it shares with others of its kind, or of its own. [worker]
  explicit Voice(std::shared_ptr<ModeTable> table);
  Voice(std::shared_ptr<const modal::StrikeMap> map, const modal::MaterialScale& material, double sample_rate_hz);

  // Adds a strike (EventType::strike or strike_vertex) at the current frame, or aside, `left` frames before the end
  // of the chunk. False when the vertex does not
  // exist. [audio]
  bool strike(const Event& event) RINGDOWN_REALTIME;
  bool strike_aside(const Event& event, std::size_t left) RINGDOWN_REALTIME;

  // Puts what a strike gives the modes into amplitudes(), and returns the sum of their squares; nullopt when the vertex
  // does not exist. [audio]
  [[nodiscard]] std::optional<double> find_amplitudes(const Event& event) RINGDOWN_REALTIME {
    return table_->strike(event, {scratch_.data(), scratch_.size()}, amplitudes_.get());
  }
  [[nodiscard]] const double* amplitudes() const RINGDOWN_REALTIME { return amplitudes_.get(); }

  // What rings, in a voice of another table of the same bank. [worker, while nothing renders either]
  [[nodiscard]] std::unique_ptr<Voice> with_table(std::shared_ptr<ModeTable> table);

  [[nodiscard]] ModeTable& table() const RINGDOWN_REALTIME { return *table_; }
  [[nodiscard]] const std::shared_ptr<ModeTable>& shared_table() const { return table_; }

  Voice* next = nullptr;  // for the mixer's lists, which must not allocate

 private:
  std::shared_ptr<ModeTable> table_;
  std::vector<double> scratch_;      // one per mode of the bank
  AlignedArray<double> amplitudes_;  // one per column
};

}  // namespace ringdown::synth
