// Gains by which the modes of a table are heard: their radiation towards the listener, and what the air absorbs on the
// way. States stay as they are; the kernels multiply (Hearing). [audio, after construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/vec3.h"
#include "engine/modal/air_absorption.h"
#include "engine/synth/kernels/aligned_array.h"
#include "engine/synth/kernels/mode_kernel.h"
#include "engine/synth/modes/mode_table.h"
#include "engine/synth/modes/state_array.h"

#include <cstddef>

namespace ringdown::synth {

class ModeGains {
 public:
  explicit ModeGains(const ModeTable& table);  // [worker]

  // Returns true if each mode has a gain of its own; otherwise all gains are 1.
  [[nodiscard]] bool on() const REALTIME { return on_; }
  void switch_off() REALTIME { on_ = moving_ = false; }

  // From the present frame on, gains move in straight lines and reach within `frames` what they are towards the unit
  // vector `toward`, in the object's frame, at a distance; with 0 frames, at once. Gains that are off begin at 1.
  void aim(const Vec3& toward, double distance_m, const modal::AirAbsorption& air, double frames) REALTIME;
  // The same, back to gains of 1.
  void aim_at_one(double frames) REALTIME;

  // Moves on. Gains that have reached their goal go on beyond it until the next aim().
  void advance(std::size_t frames) REALTIME { passed_ += static_cast<double>(frames); }
  [[nodiscard]] bool moves() const REALTIME { return moving_; }
  // Frames that are left until the goal; negative beyond it, 0 where nothing moves.
  [[nodiscard]] double left() const REALTIME { return moving_ ? length_ - passed_ : 0; }

  // Fills in the gains of a call that begins `offset` frames from now.
  void put(Hearing& hearing, std::size_t offset) const REALTIME;

  // Lets gains stand as they are now, and returns them; null when each is 1.
  const ModeFactors* freeze() REALTIME;
  // The last result of freeze(), as long as nothing has moved since.
  [[nodiscard]] const ModeFactors* frozen() const REALTIME { return on_ ? &factors_ : nullptr; }

 private:
  // aim() writes the goal where go() then writes the steps that lead to it.
  enum Row { gain_re, gain_im, step_re, step_im, air, kRows, goal_re = step_re, goal_im = step_im };
  [[nodiscard]] float* row(Row which) const REALTIME { return rows_.get() + which * columns_; }
  void begin() REALTIME;
  void go(double frames) REALTIME;

  const ModeTable& table_;
  std::size_t columns_;
  AlignedArray<float> rows_;     // kRows x columns
  AlignedArray<float> by_rank_;  // of the bank's modes by ascending frequency: real parts, then imaginary ones
  std::size_t ranks_ = 0;        // of each
  double length_ = 0, passed_ = 0;
  double air_distance_m_ = -1;  // for which row `air` holds
  modal::AirAbsorption air_;
  ModeFactors factors_;
  bool on_ = false, moving_ = false;
};

}  // namespace ringdown::synth
