// This model of hearing decides whether one pure tone hides another. A bake finds inaudible modes with it. [any]
//
// A tone at level L and critical-band rate z_j hides tones below
//
//   L - max(25, 14.5 + z_j) - slope * distance   [dB],   z_j and the distance in Bark
//
// [Zwicker & Terhardt, J. Acoust. Soc. Am. 68, 1980]. Slopes are Terhardt's [Hearing Research 1, 1979], as van den
// Doel, Knott & Pai use them to cull modes [Presence 13(1), 2004]: 27 dB/Bark towards lower pitch, 24 + 230 Hz/f_j -
// 0.2 L towards higher, L in dB SPL. The offset 14.5 + z is Schroeder, Atal & Hall's for a tone that masks [J. Acoust.
// Soc. Am. 66, 1979]; at 25 dB the beats of two close tones change the level by less than 1 dB, about the smallest
// audible change.
#pragma once

#include "engine/base/realtime.h"

namespace ringdown::modal {

// The highest audible frequency.
inline constexpr double kHighestHeard_hz = 20000;

// The smallest masking offset; at this offset beats stay below 1 dB.
inline constexpr double kMinMaskingOffset_db = 25;

// Critical-band rate in Bark, 0 ... 25 [Zwicker & Terhardt 1980, eq. 1].
double bark(double frequency_hz);

// The level below which a tone at `bark_masked` is hidden by one of frequency_hz, bark_masker = bark(frequency_hz) and
// level level_db SPL.
double masked_below_db(double level_db, double frequency_hz, double bark_masker, double bark_masked) REALTIME;

}  // namespace ringdown::modal
