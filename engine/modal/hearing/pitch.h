// The pitch of a thing: the one that its bank states, or an estimate from its modes, or none. [worker]
//
//   const Pitch pitch = pitch_of(bank);
//   if (pitch.hz) ...a musician would name it so...
//   else          ...pitch.reason says why not; pitch.tone_hz still stands for it on a keyboard...
//
// The estimate asks what is heard in the first second after a blow: on the average over the surface, along its normal,
// with contacts of 0.5 to 2 ms (from a hard mallet to a soft one), by what each mode radiates and how fast it decays.
// pitch.cpp has the model of hearing. What the estimate cannot know is how people agreed to name a thing, or that a
// fork is held against a table: that is what stated pitches are for.
#pragma once

#include "engine/modal/bank.h"
#include "engine/modal/material_scale.h"

#include <optional>
#include <string>

namespace ringdown::modal {

struct Pitch {
  std::optional<double> hz;
  bool stated = false;   // by the bank
  double strength = 0;   // 0 to 1, how far the pitch stands alone within an octave; 1 when it is stated
  double tone_hz = 440;  // the pitch, or else the frequency that comes closest to one
  std::string reason;    // why there is none: a clause such as "several partials compete"; or empty
};

// The stated pitch of the bank, or else the estimate. O(modes x (points + modes)).
Pitch pitch_of(const Bank& bank);

// The estimate alone.
Pitch estimated_pitch(const Bank& bank);

// A stated pitch of an object in another size and material, which goes as its modes do; nothing when none is stated, or
// when it would lie outside of kStatedPitch_hz.
std::optional<double> scaled_pitch(std::optional<double> pitch_hz, const MaterialScale& scale);

// "220.00 Hz (A3 +0 ct), as its maker states", or "none: several partials compete within an octave; 516.03 Hz comes
// closest to one".
std::string describe(const Pitch& pitch);

}  // namespace ringdown::modal
