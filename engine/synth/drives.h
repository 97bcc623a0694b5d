// Forces that last for a while: contact pulses played sample by sample, inputs that excite an object, and surfaces that
// slide or roll.
//
// A drive is a force in time at one place of one object. There is a fixed number of them; the audio thread takes one
// for a strike and gives it back when the pulse is over.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/aligned_array.h"
#include "engine/synth/event.h"
#include "engine/synth/rubbing.h"
#include "engine/synth/voice.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace ringdown::synth {

inline constexpr std::size_t kMaxDrives = 32;           // at a time; more strikes are shaped by their spectrum
inline constexpr std::size_t kMaxDrivenColumns = 4096;  // of an object's modes; with more, too
inline constexpr std::size_t kMaxInputs = 4;
inline constexpr double kMinPulse_frames = 4;  // what is shorter is no pulse in samples

// Where a block is read: null or a sample for each frame.
using Inputs = std::array<const float*, kMaxInputs>;

// A contact: a half-sine of unit impulse that begins at frame 0.
class HalfSine {
 public:
  HalfSine() = default;
  explicit HalfSine(double frames) RINGDOWN_REALTIME;  // >= kMinPulse_frames

  // The same contact in frames of another length. [worker]
  [[nodiscard]] HalfSine stretched(double ratio) const {
    return HalfSine(frames_ * ratio > kMinPulse_frames ? frames_ * ratio : kMinPulse_frames);
  }

  // The impulse in frames first ... first + count - 1; the sum over all is 1.
  void fill(Frame first, std::size_t count, double* impulses) const RINGDOWN_REALTIME;
  [[nodiscard]] bool over_at(Frame frame) const RINGDOWN_REALTIME { return static_cast<double>(frame) >= frames_; }

 private:
  double frames_ = 0, scale_ = 0;
};

// [audio, after construction]
struct Drive {
  AlignedArray<double> amplitudes = aligned_zeros<double>(kMaxDrivenColumns);  // of its object's modes
  Event place;                                                                 // where, and what an impulse of 1 is
  std::optional<std::size_t> input;                                            // whose samples are the force; else
  std::optional<std::uint32_t> contact;                                        // the number of what rubs; else a pulse
  Rubbing rubbing;
  HalfSine pulse;
  Frame end = 0;  // it is cut off there

  // Frames are of another length from `now` on. [worker]
  void rescale(Frame now, double ratio);

  // The impulse in frames first ... first + count - 1 of the mixer; `input` are that input's samples, or null.
  void fill(Frame first, std::size_t count, const float* samples, double* impulses) RINGDOWN_REALTIME;
  [[nodiscard]] bool over_at(Frame frame) const RINGDOWN_REALTIME {
    if (input) return false;
    return frame >= end || (contact ? rubbing.over_at(frame) : pulse.over_at(frame - place.frame));
  }
};

// Which of the drives are free.
class DrivePool {
 public:
  [[nodiscard]] std::optional<std::uint8_t> take() RINGDOWN_REALTIME {
    if (free_ == 0) return std::nullopt;
    const auto drive = static_cast<std::uint8_t>(__builtin_ctz(free_));
    free_ &= free_ - 1;
    return drive;
  }
  void give_back(std::uint8_t drive) RINGDOWN_REALTIME { free_ |= 1u << drive; }
  [[nodiscard]] Drive& operator[](std::uint8_t drive) RINGDOWN_REALTIME { return drives_[drive]; }
  [[nodiscard]] const Drive& operator[](std::uint8_t drive) const RINGDOWN_REALTIME { return drives_[drive]; }

 private:
  static_assert(kMaxDrives == 32);
  std::uint32_t free_ = ~0u;
  std::array<Drive, kMaxDrives> drives_;
};

}  // namespace ringdown::synth
