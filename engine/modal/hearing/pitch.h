// The pitch of an object: the pitch that its bank states, or an estimate from its modes, or none. [worker]
//
//   const Pitch pitch = pitch_of(bank);
//   if (pitch.hz) ...the pitch that a musician would name...
//   else          ...pitch.reason says why there is none; pitch.tone_hz still places the object on a keyboard...
//
// The estimate considers the first second after a blow, averaged over the surface, with blows along the normal and
// contacts of 0.5 to 2 ms (from a hard mallet to a soft one); each mode counts by its radiation and decay. pitch.cpp
// has the model of hearing. The estimate cannot know conventions for naming an object's pitch, or that a fork is held
// against a table; such banks state their pitch.
#pragma once

#include "engine/modal/bank.h"
#include "engine/modal/material_scale.h"

#include <optional>
#include <string>

namespace ringdown::modal {

struct Pitch {
  std::optional<double> hz;
  bool stated = false;   // true: stated by the bank
  double strength = 0;   // 0 to 1, the freedom from competing partials within an octave; 1 for a stated pitch
  double tone_hz = 440;  // the pitch; without one, the frequency that comes closest to a pitch
  std::string reason;    // why there is none: a clause such as "several partials compete"; or empty
};

// The stated pitch of the bank, or else the estimate. O(modes x (points + modes)).
Pitch pitch_of(const Bank& bank);

// The estimate alone.
Pitch estimated_pitch(const Bank& bank);

// Scales a stated pitch to another size and material, as the modes are scaled. Returns nothing if no pitch is stated or
// the result lies outside kStatedPitch_hz.
std::optional<double> scaled_pitch(std::optional<double> pitch_hz, const MaterialScale& scale);

// "220.00 Hz (A3 +0 ct), as its maker states", or "none: several partials compete within an octave; 516.03 Hz comes
// closest to one".
std::string describe(const Pitch& pitch);

}  // namespace ringdown::modal
